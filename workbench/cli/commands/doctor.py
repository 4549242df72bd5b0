"""`workbench doctor`: versions, device and folders."""

from __future__ import annotations

import argparse

from workbench.cli.command import Command
from workbench.project.project import Project
from workbench.system.terminal import say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""


def run(options: argparse.Namespace, project: Project) -> int:
    """Show versions, device and folders."""
    from workbench.cli.diagnosis import report

    lines, healthy = report(project.folder)
    say("\n".join(lines))
    return 0 if healthy else 3


COMMAND = Command(place=13, run=run, options=options)
