"""The record of limits: runs, what they tend to, and how well that is known.

The limit is Richardson's: f + d / (2^p - 1), with d the last of the differences from level to
level, and 2^p the quotient of the last two, between 2 and 8; where they have not one sign, or do
not shrink by half, the finest force itself. To that comes twice the change by a penalty twice as
stiff, which errs by one over its stiffness. The uncertainty is |d|, or a quarter of the difference
before where that is more, with that change once more, and with friction twice the change by
increments half as large; at least 0.05 % of the force, because differences can be small by chance:
they swing with the place of the contact's rim within an edge.
"""

from __future__ import annotations

import json
import re
from typing import Any

from tests.reference.axisymmetric.cases import CASES, Found, Run
from workbench.proof.validation.fem.fem_limits import RECORD

LEAST_SHARE = 5e-4
"""Of the force: the least uncertainty that is claimed."""
Row = dict[str, Any]


def load() -> dict[str, Any]:
    """The record; an empty one where there is none, or where other code made it."""
    return {"runs": []} if RECORD.stale() else RECORD.figures()


def run_row(name: str, run: Run, found: Found) -> Row:
    """A run as a row."""
    return {
        "case": name,
        "level": run.level,
        "order": run.order,
        "stiffer": run.stiffer,
        "finer": run.finer,
        "unknowns": found.unknowns,
        "forces_N": [round(force, 7) for force in found.forces_N],
        "radii_mm": [round(radius, 4) for radius in found.radii_mm],
        "steps": found.steps,
        "seconds": round(found.seconds, 1),
    }


def same_run(row: Row, name: str, run: Run) -> bool:
    """Whether a row is of this run."""
    own = (name, run.level, run.order, run.stiffer, run.finer)
    return own == tuple(row[key] for key in ("case", "level", "order", "stiffer", "finer"))


def limits(rows: list[Row], name: str) -> list[Row]:
    """What the forces of a case tend to, depth by depth; nothing where runs are missing."""
    own = [row for row in rows if row["case"] == name and row["order"] == 2]
    plain = [row for row in own if row["stiffer"] == 1.0 and row["finer"] == 1]
    plain.sort(key=lambda row: row["level"])
    base = next((row for row in plain if row["level"] == 1), None)
    if len(plain) < 3 or base is None:
        return []
    others = [row for row in own if row not in plain]
    found = []
    for at, depth_mm in enumerate(CASES[name].depths_mm):
        force_N, step_N = extrapolated([row["forces_N"][at] for row in plain])
        give_N, path_N = (
            sum(row["forces_N"][at] - base["forces_N"][at] for row in others if row[key] != 1)
            for key in ("stiffer", "finer")
        )
        off_N = step_N + 2.0 * (abs(give_N) + abs(path_N))
        found.append(
            {
                "depth_mm": depth_mm,
                "force_N": round(force_N + 2.0 * give_N, 6),
                "uncertainty_N": round(max(off_N, LEAST_SHARE * force_N), 6),
                "radius_mm": plain[-1]["radii_mm"][at],
            }
        )
    return found


def extrapolated(forces_N: list[float]) -> tuple[float, float]:
    """Limit of forces on meshes halved again and again, and how far it may be off."""
    before, last = forces_N[-2] - forces_N[-3], forces_N[-1] - forces_N[-2]
    off_N = max(abs(last), 0.25 * abs(before))
    if before * last <= 0.0 or abs(before) < 2.0 * abs(last):
        return forces_N[-1], off_N
    return forces_N[-1] + last / (min(before / last, 8.0) - 1.0), off_N


def save(rows: list[Row], head: dict[str, str]) -> None:
    """Write the record.

    Args:
        rows: The runs.
        head: What the record said of itself when they were begun.
    """
    rows = sorted(rows, key=lambda row: (row["case"], -row["order"], row["level"], row["finer"]))
    record = {
        **head,
        "elements": "order 2: Q2/P1disc, 3 x 3 points; order 1: Q1/P0, 2 x 2 points",
        "levels": "each halves all edges of the one before; edges_mm are those in contact",
        "uncertainty": "last difference from level to level, or a quarter of the one before, plus "
        "the changes by a penalty twice as stiff and by increments half as large, both doubled; "
        "at least 0.05 % of the force",
        "law": "mu / 2 (J^(-2/3) I1 - 3) + K / 2 (J - 1)^2",
        "cases": {name: _case(rows, name) for name in CASES},
        "runs": rows,
    }
    text = json.dumps(record, indent=1)
    RECORD.path.write_text(_compact(text) + "\n")


def _case(rows: list[Row], name: str) -> Row:
    case = CASES[name]
    return {
        "title": case.title,
        "young_MPa": case.body.young_MPa,
        "poisson": case.body.poisson,
        "thickness_mm": case.body.thickness_mm,
        "friction": case.friction,
        "edges_mm": [case.edge_mm * 0.5**level for level in case.levels],
        "limits": limits(rows, name),
    }


def _compact(text: str) -> str:
    """Lists of numbers on one line."""
    return re.sub(r"\[\s+([-\d.,\se]+?)\s+\]", lambda m: "[" + " ".join(m[1].split()) + "]", text)
