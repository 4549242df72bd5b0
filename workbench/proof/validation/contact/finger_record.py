"""The finger at 45 degrees by our finite elements: what presses of the contact solver are held to.

The record has forces of the press `finger_45` on uniform meshes, and what they tend to with how
well that is known: `workbench.proof.validation.fem.finger_figures` makes it and says how.
"""

from __future__ import annotations

from pathlib import Path

from workbench.system.record import Record

FEM_APART = (
    "workbench.pipeline.stages.press",
    "workbench.pipeline.stages.lattice",
    "workbench.pipeline.store",
    "workbench.pipeline.write_once",
    "workbench.system",
    "workbench.core.design.camera",
    "workbench.core.design.lighting",
    "workbench.core.design.optics",
    "workbench.core.design.photo",
    "workbench.core.press.learned",
    "workbench.proof.row",
)
"""What stands beside finite elements in the files that they import, and enters no force of them:
the contact solver, the store, the optics of a design."""
FINGER = Record(
    path=Path(__file__).with_name("finger_figures.json"),
    command="python -m workbench.proof.validation.fem.finger_figures",
    sources=(
        "workbench.proof.validation.fem.finger_figures",
        "workbench.core.objects.kinds.sphere",
        "workbench.core.objects.kinds.cylinder_end",
        "designs.finger",
    ),
    apart=(*FEM_APART, "workbench.proof.validation.contact.finger_record"),
)


def frictionless_N() -> float:
    """Normal force [N] of the ball 1 mm deep without friction, on the finest mesh.

    Raises:
        StoreError: If the record cannot be read.
    """
    return float(FINGER.figures()["frictionless_N"])


def sheared_N() -> float:
    """Force [N] against a shear of 0.5 mm along V of the ball 1 mm deep, on the finest mesh.

    Raises:
        StoreError: If the record cannot be read.
    """
    return float(FINGER.figures()["sheared_N"])


def limit_N(kind: str, depth_mm: float = 1.0) -> tuple[float, float]:
    """The limit of an object's normal force and its uncertainty [N]; depths of 0.5 and 1 mm.

    Raises:
        StoreError: If the record cannot be read.
    """
    found = FINGER.figures()["limits"][kind][f"{depth_mm:g}"]
    return float(found["force_N"]), float(found["uncertainty_N"])


def ball_N(depth_mm: float = 1.0) -> float:
    """The limit of the ball's normal force [N].

    Raises:
        StoreError: If the record cannot be read.
    """
    return limit_N("sphere", depth_mm)[0]
