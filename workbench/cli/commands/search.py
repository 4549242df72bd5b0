"""`workbench search`: designs looked for by goals, with mechanics and light in the loop.

Writes `study.jsonl` (Optuna's journal), `front.json`, `designs/*.toml`, `trials.csv`,
`summary.json` and `report.html`. What is there already goes on; several processes may work on one
folder.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from workbench.cli.cluster_option import add_cluster_option, cluster_of
from workbench.cli.command import Command
from workbench.cli.options import OUT
from workbench.core.base.check import within
from workbench.core.base.errors import DesignError
from workbench.core.base.units import human_seconds
from workbench.project.project import Project
from workbench.system.terminal import Progress, complain, say

if TYPE_CHECKING:
    from workbench.search.loop import Told


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    text = "what varies, goals and limits (docs/search.md)"
    sub.add_argument("file", type=Path, metavar="FILE", help=text)
    text = f"{OUT}; a search that is there goes on"
    sub.add_argument("--out", required=True, type=Path, metavar="DIR", help=text)
    text = "designs to compute in all, refused ones not counted (default: the file's, else 60)"
    sub.add_argument("--trials", type=int, metavar="N", help=text)
    text = "stop after so long, the running trial ends first"
    sub.add_argument("--minutes", type=float, metavar="M", help=text)
    add_cluster_option(sub)
    sub.add_argument("--json", action="store_true", help="progress and results as JSON lines")


def run(options: argparse.Namespace, project: Project) -> int:
    """Look for designs by goals: what may vary, what is wanted, what must hold.

    Returns:
        The exit code: 1 where no design keeps all limits.
    """
    from workbench.pipeline.devices import open_device
    from workbench.search.loop import Budget
    from workbench.search.outputs import FRONT, summary
    from workbench.search.problem_file import load_problem
    from workbench.search.running import run_search
    from workbench.system.folder import prepare

    problem = load_problem(options.file, project)
    trials = problem.trials if options.trials is None else options.trials
    within(trials, 1, 100_000, what="trials", unit="", at="--trials")
    minutes = float("inf") if options.minutes is None else options.minutes
    if not minutes > 0.0:
        raise DesignError(f"{minutes:g} minutes are none", hint="give some", at="--minutes")
    prepare(options.out, clear=())
    project.sweep()
    open_device()
    printer = Progress(as_json=options.json)
    with cluster_of(options.cluster, project.store, printer) as on:
        found = run_search(
            problem,
            project,
            options.out,
            Budget(trials=trials, minutes=minutes),
            monitor=lambda fraction, note="": printer("search", fraction, note),
            on_trial=_say_json if options.json else _say_trial,
            spread_on=on,
        )
    if options.json:
        say(json.dumps(summary(found)))
    else:
        say(f"{len(found.front)} designs in {options.out / FRONT}")
        say(f"open {options.out / 'report.html'}")
    return 0 if found.front else 1


def _say_trial(told: Told) -> None:
    """One line about a trial that has ended."""
    judged = told.judged
    words = f"{judged.status.value}: {judged.reason}" if judged.reason else judged.status.value
    spent = human_seconds(judged.seconds)
    complain(f"{told.counted} of {told.wanted}: trial {told.number} {words}, {spent}")


def _say_json(told: Told) -> None:
    table: dict[str, Any] = {
        "trial": told.number,
        "counted": told.counted,
        "wanted": told.wanted,
        "sampler": told.sampler,
        "status": told.judged.status.value,
        "reason": told.judged.reason,
        "seconds": told.judged.seconds,
        "parameters": dict(told.judged.parameters),
        "figures": dict(told.judged.figures),
    }
    say(json.dumps(table))


COMMAND = Command(place=8, run=run, options=options)
