"""The presses of the room `sensor` by finite elements, which fast contact was not fitted to.

    python -m workbench.proof.validation.sensor.fem_presses FOLDER [DESIGN ...]

solves each press on a mesh of its own with its error estimated, minutes a press, and keeps forces
and the share that slides. FOLDER is a project, so a run that was stopped goes on; designs that are
not named keep what was recorded of them by the same code.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from workbench.core.press.press_case import PressCase
from workbench.edit.indenter_choice import choose_indenter
from workbench.planning.plan import InlineRunner, evaluate, plan
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.proof.validation.contact.finger_record import FEM_APART
from workbench.proof.validation.sensor.by_design import record_by_design
from workbench.proof.validation.sensor.sensor_figures import (
    DEPTH_MM,
    FRAMES,
    OBJECTS,
    SHEAR_MM,
    SIZE_MM,
    record_press,
)
from workbench.system.record import Record

RECORD = Record(
    path=Path(__file__).with_name("fem_presses.json"),
    command="python -m workbench.proof.validation.sensor.fem_presses FOLDER",
    sources=(
        "workbench.pipeline.stages.fem",
        *(f"designs.{family}" for family in ("finger", "pad", "trunk", "paw")),
        *(f"workbench.core.objects.kinds.{thing}" for thing in OBJECTS),
    ),
    apart=(*FEM_APART, "workbench.core.base.codec"),
)

PRESSED = (SIZE_MM, DEPTH_MM, FRAMES, SHEAR_MM)
"""What was pressed, and how: a record of other presses is no reference."""


def solved(name: str, thing: str, project: Project) -> dict[str, Any]:
    """Figures of one press, frame by frame."""
    design = load_design(name, project=project)
    case = PressCase(indenter=choose_indenter(thing, size_mm=SIZE_MM), press=record_press(design))
    for _ in evaluate(design, case, InlineRunner(project.store), wanted=("fem",)):
        pass
    found = project.store.load("fem", plan(design, case)["fem"].key)
    return {
        "pressed": list(PRESSED),
        "normal_N": found.normal_N.tolist(),
        "across_N": found.tangential_N.tolist(),
        "slip": found.sliding_share.tolist(),
        "error": found.force_error.tolist(),
        "converged": bool(found.converged.all()),
    }


def solved_design(name: str, project: Project) -> dict[str, Any]:
    """Figures of all objects on a design."""
    return {thing: solved(name, thing, project) for thing in OBJECTS}


def main(words: Sequence[str] | None = None) -> int:
    """Solve and record; 1 where something failed."""
    return record_by_design(RECORD, solved_design, __doc__, words)


if __name__ == "__main__":
    sys.exit(main())
