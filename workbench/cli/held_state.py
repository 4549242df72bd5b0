"""Design and press that a command starts from: a file brings its press, options change it."""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path

from workbench.cli.body_arguments import placed_design
from workbench.cli.press_arguments import changed_design
from workbench.cli.press_options import press_case
from workbench.core.press.press_case import PressCase
from workbench.edit.typed_fields import sets
from workbench.pipeline.touching_side import touching_notice
from workbench.planning.fitting import fitted
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.project.aim import default_target_mm
from workbench.project.design_toml import parse_toml
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State, fresh_state, read_state
from workbench.system.terminal import Progress, complain


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
