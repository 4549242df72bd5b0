"""`workbench dataset status`: how far a data set is, and what failed."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from workbench.cli.command import Command
from workbench.project.project import Project
from workbench.system.terminal import say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("--json", action="store_true", help="answer as JSON")
    sub.add_argument("folder", type=Path, metavar="DIR", help="the data set")


def run(options: argparse.Namespace, project: Project) -> int:
    """Say how far a data set is, and what failed."""
    from workbench.learning.dataset.folder import DataSet

    data = DataSet.open(options.folder)
    counts, failed = data.counts(), data.failed()
    if options.json:
        answer = {"key": data.key, "program": data.manifest["program"], **counts}
        say(json.dumps({**answer, "failed": list(failed.values())}))
        return 0
    say(
        f"{counts['samples_done']} of {counts['samples']} samples ({counts['samples_distinct']} "
        f"distinct), {counts['cases_done']} of {counts['cases']} cases complete, "
        f"{counts['cases_failed']} failed"
    )
    splits = counts["samples_by_split"]
    say("samples by split: " + ", ".join(f"{name} {count}" for name, count in splits.items()))
    for name, row in failed.items():
        say(f"failed {name}: {row['message']}")
    return 0


COMMAND = Command(place=2, run=run, options=options)
