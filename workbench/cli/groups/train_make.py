"""`workbench train make`: train a network on a data set, or go on with a training."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING

from workbench.project.project import Project

if TYPE_CHECKING:
    pass
from workbench.cli.command import Command
from workbench.cli.training import add_data_options, add_training_options, train


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    add_data_options(sub)
    add_training_options(sub, preset="small")


def run(options: argparse.Namespace, project: Project) -> int:
    """Train a network on a data set, or go on with a training that was stopped."""
    return train(options, base=None)


COMMAND = Command(place=1, run=run, options=options)
