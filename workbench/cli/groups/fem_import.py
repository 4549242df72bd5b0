"""`workbench fem import`: another program's forces beside ours."""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import Any

import numpy as np

from workbench.cli.command import Command
from workbench.core.base.errors import StoreError
from workbench.core.result.force_field import ForceField
from workbench.project.project import Project
from workbench.project.state import State
from workbench.report.fabrication_tables import plain_numbers
from workbench.report.fem_case import deck_case, read_carried, solved
from workbench.report.fem_tables import beside
from workbench.system.terminal import Progress, say


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("deck", type=Path, metavar="CASE.inp", help="what export wrote")
    text = "CalculiX's .dat, or step,node,ux,uy,uz,fx,fy,fz as .csv"
    sub.add_argument("result", type=Path, metavar="RESULT", help=text)
    sub.add_argument("--json", action="store_true", help="the comparison as JSON")


def run(options: argparse.Namespace, project: Project) -> int:
    """Compare another program's results of a deck with ours."""
    from sim.fem.decks.text import carried_text

    deck = _text(options.deck)
    state, element = read_carried(carried_text(deck), project, source=str(options.deck))
    printer = Progress(as_json=False)
    theirs = read_theirs(deck, options.result, state, element, project)
    ours = solved(state, project, printer)
    found = beside(ours, theirs)
    if options.json:
        say(json.dumps(plain_numbers(found)))
        return 0
    say(f"ours:   {found['ours']}\ntheirs: {found['theirs']}")
    say("frame   normal [N]: ours   theirs      ratio   tangential [N]: ours   theirs   balance")
    for row in found["frames"]:
        say(
            f"{row['frame']:5} {row['normal_N']:18.4f} {row['their_normal_N']:8.4f} "
            f"{row['ratio']:10.4f} {row['tangential_N']:22.4f} {row['their_tangential_N']:8.4f} "
            f"{row['their_balance']:9.4f}"
        )
    return 0


def read_theirs(deck: str, path: Path, state: State, element: Any, project: Project) -> ForceField:
    """Another program's result of a deck.

    Raises:
        StoreError: If the deck has another mesh than this version makes, or the result is
            truncated or of another deck.
        SolveError: If it has fewer steps than frames.
    """
    from sim.fem.decks.dat import read_dat
    from sim.fem.decks.results import force_field, read_table
    from sim.fem.decks.text import read_deck

    ready, mesh = deck_case(state, element, project)
    points_mm = ready.submodel.body.points_mm
    known = read_deck(deck).nodes.get("NPART", np.zeros((0, 4)))[: len(points_mm), 1:]
    if known.shape != points_mm.shape or not np.allclose(known, points_mm, rtol=0.0, atol=1e-6):
        raise StoreError(
            "the deck has other nodes than this version of the workbench gives the case",
            hint="export it again and solve that deck",
        )
    text = _text(path)
    result = read_table(text, ready) if path.suffix == ".csv" else read_dat(text, ready)
    return force_field(result, ready, len(mesh.outer.points_mm), state.case.fem.hex_mm)


def _text(path: Path) -> str:
    try:
        return path.read_text(encoding="utf-8", errors="replace")
    except OSError as error:
        raise StoreError(
            f"cannot read {path}: {error.strerror or error}", hint="check its name", at=str(path)
        ) from error


COMMAND = Command(place=3, run=run, options=options)
