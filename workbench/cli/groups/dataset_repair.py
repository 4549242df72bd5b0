"""`workbench dataset repair`: drop damaged samples and forget failures."""

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
    """Drop damaged samples and forget failures, so that make tries them anew."""
    from workbench.learning.dataset.repair import repair as repair_it

    dropped = repair_it(options.folder)
    for path, reason in dropped:
        row = {"dropped": str(path), "reason": reason}
        say(json.dumps(row) if options.json else f"dropped {path}: {reason}")
    if not options.json:
        say(f"{len(dropped)} damaged samples dropped")
    return 0


COMMAND = Command(place=4, run=run, options=options)
