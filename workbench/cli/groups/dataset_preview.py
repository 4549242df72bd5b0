"""`workbench dataset preview`: draw a sheet of samples."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

from workbench.cli.command import Command
from workbench.core.base.errors import DesignError
from workbench.project.project import Project
from workbench.system.terminal import say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("--json", action="store_true", help="answer as JSON")
    sub.add_argument("folder", type=Path, metavar="DIR", help="the data set")


def run(options: argparse.Namespace, project: Project) -> int:
    """Draw a sheet of samples."""
    from workbench.learning.dataset.folder import DataSet
    from workbench.learning.dataset.sample_sheet import SHEET, write_sheet

    if not write_sheet(DataSet.open(options.folder)):
        raise DesignError(
            f"{options.folder} has no samples yet", hint="make some first", at=str(options.folder)
        )
    path = options.folder / SHEET
    say(json.dumps({"file": str(path)}) if options.json else path)
    return 0


COMMAND = Command(place=3, run=run, options=options)
