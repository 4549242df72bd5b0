"""Design, press and settings of the commands of finite elements."""

from __future__ import annotations

import argparse
import dataclasses

from workbench.cli.body_arguments import add_body_options
from workbench.cli.held_state import base_state
from workbench.cli.press_arguments import add_press_options
from workbench.cli.press_options import SETTINGS
from workbench.core.base.errors import DesignError
from workbench.core.press.fem import DRAFT_MM
from workbench.project.project import Project
from workbench.project.state import State
from workbench.system.terminal import Progress

OTHER_SOLVER = (*SETTINGS, "extent", "method", "light_model", "camera", "led")
"""Options of `run` that finite elements have no use for."""


def add_case_options(sub: argparse.ArgumentParser) -> None:
    """Design, press, mesh and part."""
    sub.add_argument("design", metavar="NAME|FILE", help="a file brings its press")
    add_body_options(sub)
    add_press_options(sub)
    sub.add_argument("--draft", action="store_true", help="0.9 mm mesh: forces within 5 %%")
    text = "part that takes part, about the target (default 12); 0: all"
    sub.add_argument("--radius-mm", type=float, help=text)


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
