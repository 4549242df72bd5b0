"""Makes readers such as ship, from nothing: presses, views, training, and whether they are good.

`python -m workbench.learning.readers.shipped_readers FOLDER [MINUTES] [NAME...]` trains the readers
of the presets below, so many minutes each (9), and copies those that are good enough to where
`workbench read` finds them; what was made already is kept. It is meant for a machine with a GPU.
"""

from __future__ import annotations

import shutil
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from sim.reading.network.reader_file import SUFFIX
from workbench.learning.readers.train_reader import ReaderPlan, train_reader
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading.find_reader import SHIPPED
from workbench.system.processes import cores
from workbench.system.terminal import Progress, complain, say

MEMBRANES = ("geltip", "pad")
MINUTES = 9.0
LARGEST_SHARE = 0.35
"""Of the error of saying zero depth, that a reader may have on what tests it."""
WITHIN_SIGMA = (0.60, 0.76)
"""Share of its errors that lie within one standard deviation."""
SIZE = "full"


def shortcomings(scores: dict[str, Any]) -> list[str]:
    """Why a reader of such scores does not ship; nothing if it does."""
    found = []
    share = scores["depth_mae_mm"] / max(scores["zero_mae_mm"], 1e-9)
    if share > LARGEST_SHARE:
        found.append(f"depth is off by {share:.2f} of saying zero, at most {LARGEST_SHARE}")
    low, high = WITHIN_SIGMA
    if not low <= scores["within_sigma"] <= high:
        within = scores["within_sigma"]
        found.append(f"{within:.2f} of the errors lie within sigma, not {low} to {high}")
    return found


def main(words: Sequence[str]) -> int:
    """Train them all; 0 if all are good enough."""
    folder, minutes = Path(words[0]), float(words[1]) if len(words) > 1 else MINUTES
    project, bad = Project(folder / "project"), 0
    for name in words[2:] or MEMBRANES:
        done = train_reader(
            load_design(name),
            folder / f"{name}{SUFFIX}",
            project,
            ReaderPlan(size=SIZE, minutes=minutes, jobs=cores()),
            tell=lambda row: complain(str(row)),
            monitor=Progress(as_json=False),
        )
        lacking = shortcomings(done.scores)
        say(f"{name}: {done.scores}")
        for reason in lacking:
            complain(f"{name} does not ship: {reason}")
        bad += bool(lacking)
        if not lacking:
            SHIPPED.mkdir(exist_ok=True)
            shutil.copy(done.path, SHIPPED)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
