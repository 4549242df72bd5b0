"""`workbench sweep`: one number of a design in steps, as plot data and report.

Writes `sweep.json` (every point with value, status, figures and keys), `sweep.csv` (the same
figures as a table) and `sweep.html`. Results are stored: a sweep that was stopped and is asked for
again goes on where it was.
"""

from __future__ import annotations

import argparse
import csv
import dataclasses
import io
import json
import time
from pathlib import Path
from typing import Any

from workbench.aim import default_target_mm
from workbench.body_arguments import placed_design
from workbench.core.errors import Cancelled, DesignError, WorkbenchError, shown
from workbench.core.mapping import suggest
from workbench.core.units import human_seconds
from workbench.design_toml import parse_toml
from workbench.fitting import fitted
from workbench.named_designs import load_design
from workbench.pipeline import InlineRunner, PressCase, evaluate, plan
from workbench.press_arguments import changed_design
from workbench.press_options import press_case
from workbench.project import Project
from workbench.state import State, fresh_state, read_state
from workbench.sweeps import Status, Sweep, done, failed, make_sweep, metrics_of, state_at
from workbench.terminal import Progress, complain, say
from workbench.touching_side import touching_notice
from workbench.typed_fields import sets
from workbench.whole_files import write_atomically

FILES = ("sweep.json", "sweep.csv", "sweep.html")


def sweep(options: argparse.Namespace, project: Project) -> int:
    """Run a design at several values of one parameter; write figures, plot and images."""
    from workbench.comparison_report import sweep_page
    from workbench.folder import prepare
    from workbench.metric_rules import RULES

    if options.metric and options.metric not in RULES:
        hint = suggest(options.metric, RULES)
        raise DesignError(f"there is no figure {shown(options.metric)}", hint=hint, at="--metric")
    printer = Progress(as_json=options.json)
    what = make_sweep(
        "sweep",
        base_state(options, project, printer),
        options.field,
        start=options.start,
        stop=options.stop,
        steps=options.steps,
        parts=options.parts,
    )
    prepare(options.out, clear=FILES)
    project.sweep()
    what = compute(what, project, printer, as_json=options.json)
    contents = {
        "sweep.json": json.dumps(sweep_table(what), indent=1, allow_nan=False),
        "sweep.csv": sweep_csv(what),
        "sweep.html": sweep_page(project.store, what, options.metric or ""),
    }
    for name, content in contents.items():
        write_atomically(options.out / name, content.encode())
    if options.json:
        say(json.dumps(sweep_table(what), allow_nan=False))
    else:
        say(f"open {options.out / 'sweep.html'}")
    return 0 if all(point.status is Status.DONE for point in what.points) else 3


def base_state(options: argparse.Namespace, project: Project, printer: Progress) -> State:
    """Design and press that the options name; a design file brings the press that it holds.

    Raises:
        DesignError: If there is no such design or a value is refused.
    """
    design = placed_design(options, load_design(options.design, project=project))
    design = changed_design(options, design)
    held = _held_case(options, project)
    state = fresh_state(design) if held is None else State(design=design, case=held)
    # What is wrong with the options is said before anything is built.
    case = press_case(options, design, state.case.press.target_mm, held)
    if design.body is not None and held is None:
        chosen = sets(options.set, "optics.ring")
        state = _aimed(state, project, printer, fits_ring=not chosen)
        case = press_case(options, state.design, state.case.press.target_mm, held)
    touching = touching_notice(case.indenter)
    if touching:
        complain(f"notice: {touching}")
    return State(design=state.design, case=case)


def _held_case(options: argparse.Namespace, project: Project) -> PressCase | None:
    """The press that a design file holds, None without one.

    Raises:
        DesignError: If it is not valid.
    """
    if not options.design.endswith(".toml"):
        return None
    text = Path(options.design).read_text(encoding="utf-8")
    if "press_case" not in parse_toml(text, source=options.design):
        return None
    return read_state(text, project, source=options.design).case


def _aimed(state: State, project: Project, printer: Progress, *, fits_ring: bool) -> State:
    """A body from a file has to be built to be aimed at; a ring nobody chose is made to fit."""
    runner = InlineRunner(project.store)
    for outcome in evaluate(state.design, state.case, runner, wanted=("build",), monitor=printer):
        printer.done(outcome)
    solid = project.store.load("build", plan(state.design, state.case)["build"].key)
    design = fitted(state.design, solid)[0] if fits_ring else state.design
    press = dataclasses.replace(state.case.press, target_mm=default_target_mm(design, solid))
    return State(design=design, case=dataclasses.replace(state.case, press=press))


def compute(what: Sweep, project: Project, printer: Progress, *, as_json: bool) -> Sweep:
    """All points in order; one that fails is told and left.

    Raises:
        Cancelled: If the user asked to stop; finished results are stored.
    """
    runner = InlineRunner(project.store)
    for number, point in enumerate(what.points):
        started = time.monotonic()
        try:
            state = state_at(what, number)
            for outcome in evaluate(
                state.design, state.case, runner, wanted=what.wanted, monitor=printer
            ):
                printer.done(outcome)
            what = done(what, number, project.store, time.monotonic() - started)
        except Cancelled:
            raise
        except WorkbenchError as error:
            what = failed(what, number, error)
        spent = human_seconds(time.monotonic() - started)
        told = what.points[number]
        if not as_json:
            words = told.message or "done"
            complain(f"{number + 1} of {len(what.points)}: {point.value:g} {words}, {spent}")
    return what


def sweep_table(what: Sweep) -> dict[str, Any]:
    """A sweep as plain tables."""
    return {
        "schema": 1,
        "design": what.base.design.name,
        "family": what.base.design.family,
        "field": what.path,
        "label": what.field.label,
        "unit": what.field.unit,
        "points": [
            {
                "value": point.value,
                "status": point.status.value,
                "message": point.message,
                "figures": dict(point.figures),
                "keys": dict(point.keys),
            }
            for point in what.points
        ],
    }


def sweep_csv(what: Sweep) -> str:
    """Values and figures as comma-separated values; what a point has not is empty."""
    names = metrics_of(what)
    buffer = io.StringIO()
    writer = csv.writer(buffer, lineterminator="\n")
    writer.writerow([what.path.rpartition(".")[2], "status", *names])
    for point in what.points:
        figures = [point.figures.get(name, "") for name in names]
        writer.writerow([point.value, point.status.value, *figures])
    return buffer.getvalue()
