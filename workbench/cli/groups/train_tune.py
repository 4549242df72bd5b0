"""`workbench train tune`: train the decoder of weights on presses of another gel."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.project.project import Project

if TYPE_CHECKING:
    pass
from workbench.cli.command import Command
from workbench.cli.training import add_data_options, add_training_options, train


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    add_data_options(sub)
    sub.add_argument("--weights", required=True, type=Path, metavar="FILE", help="to start from")
    add_training_options(sub, preset="tune")


def run(options: argparse.Namespace, project: Project) -> int:
    """Train the decoder of weights on a few presses of another gel."""
    return train(options, base=options.weights)


COMMAND = Command(place=2, run=run, options=options)
