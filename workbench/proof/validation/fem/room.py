"""FEM: our finite elements beside exact answers, themselves, and recorded figures of others.

`rows` takes some minutes; `fine_rows` has what takes longer, the finest mesh and cases of the
robustness matrix solved anew. CalculiX itself is asked where `ccx` is installed. The contact
solver is pressed beside our finite elements (`fem_mpm`) and limits of small contacts (`tips`), and
compared with figures of an independent quasi-static solver (mean-dilatation hexahedra, hard
contact, Coulomb 0.3) and of CalculiX (C3D8I) on the finger at 45 degrees; the null there is the
frictionless force: a solver without friction would score it.
"""

from __future__ import annotations

from workbench.proof.row import Row, compared
from workbench.proof.validation.contact.presses import NAME, finger_press
from workbench.proof.validation.fem import (
    calculix,
    fem_exact,
    fem_limits,
    fem_matrix,
    fem_meshes,
    fem_mpm,
    fem_paths,
    sliding_shares,
    tips,
)

FEM_NORMAL_N = {"0.30 mm hexahedra": 1.291, "CalculiX C3D8I": 1.276}
"""Normal force [N] by solver, on the finest mesh of each."""
LIMIT = 0.07
"""At a grid of a quarter wall MPM reads 3-5 % low and FEM at 0.3 mm still falls by 1-2 %."""


def rows() -> list[Row]:
    """All rows that take seconds to a minute each."""
    return [
        *fem_exact.rows(),
        *fem_paths.rows(),
        *fem_meshes.rows(),
        *fem_mpm.rows(),
        *fem_limits.rows(),
        *sliding_shares.rows(),
        *tips.rows(),
        *fem_matrix.recorded_rows(),
        *_recorded(),
        *(calculix.rows() if calculix.installed() else ()),
    ]


def fine_rows() -> list[Row]:
    """Rows that take minutes each."""
    return [*fem_meshes.fine_rows(), *fem_mpm.fine_rows(), *fem_matrix.repeated_rows()]


def _recorded() -> list[Row]:
    """The contact solver beside figures of other programs."""
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
