"""`workbench validate`: numbers beside closed forms, limits and nulls."""

from __future__ import annotations

import argparse
from pathlib import Path

from workbench.cli.cluster_option import add_cluster_option
from workbench.cli.command import Command
from workbench.cli.measured_rows import expect_room, print_rows
from workbench.project.project import Project

ROOMS = (
    "geometry, parts, contact, optics, fem, fem_fine, fem_calculix, forces, robustness, "
    "robustness_sample, optics_mitsuba, published, reading, tasks, sensor, search"
)
"""Named here too, because finding them imports the whole program; a test compares."""


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    text = f"one or more of {ROOMS}"
    sub.add_argument("rooms", metavar="ROOM", nargs="+", help=text)
    sub.add_argument("--json", action="store_true", help="the rows as a JSON list")
    text = "also keep the rows with this machine's name, the date, and the code that they rest on"
    sub.add_argument("--record", type=Path, metavar="FILE", help=text)
    text = "an independent program to compare with: mitsuba for optics, calculix for fem"
    sub.add_argument("--reference", metavar="NAME", help=text)
    text = "for forces: a data set to score learned forces on, instead of what ships"
    sub.add_argument("--data", type=Path, metavar="DATA", help=text)
    add_cluster_option(sub)


def run(options: argparse.Namespace, project: Project) -> int:
    """Compare with closed forms."""
    from workbench.cli.spread_rooms import print_rooms
    from workbench.cli.validate_rooms import ROOMS as ALL
    from workbench.cli.validate_rooms import room_of, with_data
    from workbench.proof.judge import judged

    asked = [
        room_of(room, options.reference) if options.reference else room for room in options.rooms
    ]
    for room in asked:
        expect_room(room, ALL)
        if options.data is not None:
            with_data(room, options.data)
    if options.cluster is not None or len(asked) > 1:
        return print_rooms(options, asked, project)
    options.room = asked[0]
    rooms = ALL if options.data is None else with_data(options.room, options.data)
    return print_rows(options, rooms, judged=judged)


COMMAND = Command(place=5, run=run, options=options)
