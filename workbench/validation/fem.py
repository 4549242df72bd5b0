"""FEM: the contact solver beside finite-element figures recorded for the same case.

The figures are constants of an independent quasi-static solver (mean-dilatation hexahedra, hard
contact, Coulomb 0.3) and of CalculiX (C3D8I) on the finger at 45 degrees; the solver itself comes
to this program later. The null is the frictionless force: a solver without friction would score it.
"""

from __future__ import annotations

from workbench.rows import Row, compared
from workbench.validation.presses import NAME, finger_press

FEM_NORMAL_N = {"0.30 mm hexahedra": 1.291, "CalculiX C3D8I": 1.276}
"""Normal force [N] by solver, on the finest mesh of each."""
LIMIT = 0.07
"""At a grid of a quarter wall MPM reads 3-5 % low and FEM at 0.3 mm still falls by 1-2 %."""


def rows() -> list[Row]:
    """All rows of the room."""
    return [
        compared(
            "finger_45_normal_force",
            f"MPM 0.5 mm against {mesh}; {NAME}",
            lambda: float(finger_press().normal_N[-1]),
            reference_N,
            unit="N",
            limit=LIMIT,
            null=lambda: float(finger_press(friction=0.0).normal_N[-1]),
        )
        for mesh, reference_N in FEM_NORMAL_N.items()
    ]
