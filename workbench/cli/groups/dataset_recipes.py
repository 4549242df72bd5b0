"""`workbench dataset recipes`: those that come with the program."""

from __future__ import annotations

import argparse
import json

from workbench.cli.command import Command
from workbench.learning.dataset.recipes import RECIPES
from workbench.project.project import Project
from workbench.system.terminal import say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("--json", action="store_true", help="answer as JSON")


def run(options: argparse.Namespace, project: Project) -> int:
    """List the recipes that come with the program."""
    for name, (_, purpose) in RECIPES.items():
        row = {"name": name, "purpose": purpose}
        say(json.dumps(row) if options.json else f"{name:14} {purpose}")
    return 0


COMMAND = Command(place=5, run=run, options=options)
