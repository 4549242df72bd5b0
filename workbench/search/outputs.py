"""The files of a search: `front.json`, `designs/*.toml`, `trials.csv` and more."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project
from workbench.project.state import State, case_table
from workbench.search.finalists import Finalist
from workbench.search.front import Found
from workbench.search.front_plot import front_svg
from workbench.search.judged import savings
from workbench.system.folder import remove_stale
from workbench.system.whole_files import write_atomically

FRONT, TABLE, SUMMARY, REPORT = "front.json", "trials.csv", "summary.json", "report.html"
PLOT, DESIGNS = "front.svg", "designs"


def write_front(out: Path, found: Found, listed: Sequence[Finalist], project: Project) -> None:
    """Write all but the report; designs of an earlier front go.

    Raises:
        StoreError: If the folder cannot be written.
    """
    files = {f"{DESIGNS}/{one.name}.toml": _design(one.state, project) for one in listed}
    remove_stale(out, (f"{DESIGNS}/front [0-9]*.toml",), keep=files)
    for name, text in files.items():
        write_atomically(out / name, text.encode())
    rows = [front_row(one) for one in listed]
    write_atomically(out / FRONT, json.dumps(rows, indent=1, allow_nan=False).encode())
    write_atomically(out / TABLE, trials_csv(found).encode())
    write_atomically(out / PLOT, front_svg(found).encode())
    write_atomically(out / SUMMARY, json.dumps(summary(found), indent=1).encode())


def _design(state: State, project: Project) -> str:
    project.keep_files(state.design)
    return design_to_toml(state.design, press_case=case_table(state.case, project))


def front_row(one: Finalist) -> dict[str, Any]:
    """A design of the front as `front.json` has it."""
    trial = one.trial
    row: dict[str, Any] = {
        "name": one.name,
        "design": f"{DESIGNS}/{one.name}.toml",
        "figures": dict(trial.judged.figures),
        "parameters": dict(trial.judged.parameters),
        "trial": trial.number,
        "sampler": trial.sampler,
    }
    if one.confirmed is not None:
        row["confirmed"] = {
            "holds": one.holds,
            "reason": one.confirmed.reason,
            "figures": dict(one.confirmed.figures),
        }
    if one.photons is not None:
        row["photons"] = dict(one.photons.figures)
    if one.worst is not None:
        worst = one.worst
        row["worst"] = {
            "figures": dict(worst.figures),
            "twins": worst.twins,
            "lost": worst.lost,
            "kept": worst.kept,
        }
    return row


def trials_csv(found: Found) -> str:
    """All trials as comma-separated values; what one has not is empty."""
    parameters = dict.fromkeys(name for t in found.trials for name in t.judged.parameters)
    figures = dict.fromkeys(name for t in found.trials for name in t.judged.figures)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    head = ("trial", "proposed by", "status", "reason", "allowed", "seconds")
    writer.writerow([*head, *parameters, *figures])
    for trial in found.trials:
        judged = trial.judged
        about = [trial.number, trial.sampler, judged.status.value, judged.reason]
        about += [trial.allowed, round(judged.seconds, 3)]
        values = [judged.parameters.get(name, "") for name in parameters]
        values += [judged.figures.get(name, "") for name in figures]
        writer.writerow([*about, *values])
    return buffer.getvalue()


def summary(found: Found) -> dict[str, Any]:
    """A search as it stands, in plain tables."""
    saved = savings(trial.judged for trial in found.trials)
    refused = len(found.trials) - found.counted
    return {
        "schema": 1,
        "base": found.problem.base.design.name,
        "goals": [goal.figure for goal in found.problem.goals],
        "trials": found.counted,
        "refused": refused,
        "allowed": sum(trial.allowed for trial in found.trials),
        "front": len(found.front),
        "seconds": round(sum(trial.judged.seconds for trial in found.trials), 1),
        "computed": dict(saved.ran),
        "found": dict(saved.found),
        "spared": dict(saved.skipped),
    }
