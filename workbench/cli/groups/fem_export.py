"""`workbench fem export`: write a press as an input deck of CalculiX or Abaqus."""

from __future__ import annotations

import argparse
from pathlib import Path

from workbench.cli.command import Command
from workbench.cli.fem_state import add_case_options, fem_state
from workbench.core.base.errors import DesignError
from workbench.project.project import Project
from workbench.report.fem_case import carried, deck_case
from workbench.system.terminal import Progress, say
from workbench.system.whole_files import write_atomically


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    add_case_options(sub)
    elements = ("C3D8", "C3D8I", "C3D20R")
    sub.add_argument("--element", choices=elements, default="C3D20R", help="default C3D20R")
    sub.add_argument("--out", required=True, type=Path, metavar="CASE.inp", help="the deck")


def run(options: argparse.Namespace, project: Project) -> int:
    """Write a press as an input deck of CalculiX or Abaqus."""
    from sim.fem.decks.deck import write_deck
    from sim.fem.decks.mesh import Element

    if options.out.is_dir() or options.out.suffix != ".inp":
        raise DesignError(
            f"{options.out} is not the name of a deck", hint="for example case.inp", at="--out"
        )
    printer = Progress(as_json=False)
    state, element = fem_state(options, project, printer), Element(options.element)
    ready, _ = deck_case(state, element, project, printer)
    text = write_deck(ready, carried(state, element, project))
    write_atomically(options.out, text.encode())
    name = options.out.with_suffix("")
    say(f"{options.out}: {ready.approach.frame_count} steps; solve it with `ccx -i {name}`,")
    say(f"then `workbench fem import {options.out} {name}.dat`")
    return 0


COMMAND = Command(place=2, run=run, options=options)
