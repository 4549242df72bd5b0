"""`workbench bench`: how long the parts take here."""

from __future__ import annotations

import argparse
from pathlib import Path

from workbench.cli.command import Command
from workbench.cli.measured_rows import print_rows
from workbench.project.project import Project

ROOMS = (
    "geometry, contact, optics, forces, pipeline, browser, efficiency, reading, sensor, stages, all"
)
"""Named here too, because finding them imports the whole program; a test compares."""


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("room", metavar="ROOM", help=f"one of {ROOMS}")
    sub.add_argument("--json", action="store_true", help="the rows as a JSON list")
    text = "also keep the rows with this machine's name and the date"
    sub.add_argument("--record", type=Path, metavar="FILE", help=text)


def run(options: argparse.Namespace, project: Project) -> int:
    """Measure speed."""
    from workbench.cli.bench_rooms import ROOMS as ALL

    return print_rows(options, ALL)


COMMAND = Command(place=6, run=run, options=options)
