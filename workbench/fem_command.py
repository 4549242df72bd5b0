"""`workbench fem`: solve a press by finite elements, or have another program check it.

`export` writes the case as a deck of CalculiX or Abaqus that carries design and press; `import`
reads that program's results and prints its forces beside ours, frame by frame.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.errors import DesignError, StoreError
from workbench.core.fem import DRAFT_MM
from workbench.core.force_field import ForceField
from workbench.fem_case import carried, deck_case, read_carried, solved
from workbench.fem_tables import beside, columns, frame_rows, npz_bytes
from workbench.forces import csv_bytes
from workbench.outputs import frame_depths_mm, plain_numbers
from workbench.press_options import SETTINGS
from workbench.project import Project
from workbench.state import State
from workbench.sweep_command import base_state
from workbench.terminal import Progress, say
from workbench.whole_files import write_atomically

FILES = ("forces.npz", "forces.csv")
OTHER_SOLVER = (*SETTINGS, "extent", "method", "light_model")
"""Options of `run` that finite elements have no use for."""


def solve(options: argparse.Namespace, project: Project) -> int:
    """Press a design by finite elements; write forces and displacements."""
    from workbench.folder import prepare

    printer = Progress(as_json=options.json)
    state = fem_state(options, project, printer)
    prepare(options.out, clear=FILES)
    found = solved(state, project, printer)
    depths_mm = frame_depths_mm(state.case.press, found)
    write_atomically(options.out / "forces.npz", npz_bytes(found))
    write_atomically(options.out / "forces.csv", csv_bytes(columns(found, depths_mm)))
    if options.json:
        say(
            json.dumps(
                plain_numbers({"solver": found.solver, "frames": frame_rows(found, depths_mm)})
            )
        )
        return 0
    for row in frame_rows(found, depths_mm):
        say(
            f"frame {row['frame']:3}  {row['depth_mm']:6.3f} mm  normal {row['normal_N']:8.4f} N  "
            f"tangential {row['tangential_u_N']:8.4f}, {row['tangential_v_N']:8.4f} N  "
            f"residual {row['residual']:.1e}"
        )
    say(options.out / "forces.csv")
    return 0


def export(options: argparse.Namespace, project: Project) -> int:
    """Write a press as an input deck of CalculiX or Abaqus."""
    from sim.fem.deck import write_deck
    from sim.fem.deck_mesh import Element

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


def import_results(options: argparse.Namespace, project: Project) -> int:
    """Compare another program's results of a deck with ours."""
    from sim.fem.deck_text import carried_text

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


def fem_state(options: argparse.Namespace, project: Project, printer: Progress) -> State:
    """Design, press and settings that the options name.

    Raises:
        DesignError: If there is no such design, a value is refused, or an option belongs to the
            contact solver.
    """
    for name in OTHER_SOLVER:
        if getattr(options, name) is not None:
            option = f"--{name.replace('_', '-')}"
            raise DesignError(
                f"{option} is not for finite elements",
                hint="leave it out; --draft and --radius-mm choose mesh and part",
                at=option,
            )
    state = base_state(options, project, printer)
    named: dict[str, float] = {"hex_mm": DRAFT_MM} if options.draft else {}
    if options.radius_mm is not None:
        named["radius_mm"] = options.radius_mm
    settings = dataclasses.replace(state.case.fem, **named)
    return State(design=state.design, case=dataclasses.replace(state.case, fem=settings))


def read_theirs(deck: str, path: Path, state: State, element: Any, project: Project) -> ForceField:
    """Another program's result of a deck.

    Raises:
        StoreError: If the deck has another mesh than this version makes, or the result is
            truncated or of another deck.
        SolveError: If it has fewer steps than frames.
    """
    from sim.fem.deck_dat import read_dat
    from sim.fem.deck_results import force_field, read_table
    from sim.fem.deck_text import read_deck

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
