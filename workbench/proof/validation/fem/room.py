"""FEM: our finite elements beside exact answers, themselves, and recorded figures of others.

`rows` takes some minutes; `fine_rows` has what takes longer, the finest mesh and cases of the
robustness matrix solved anew. CalculiX itself is asked where `ccx` is installed. The contact solver
is pressed beside our finite elements (`fem_mpm`) and limits of small contacts (`tips`), and on the
finger at 45 degrees compared with their limit on record and with a figure of CalculiX; the null
there is the frictionless force: a solver without friction would score it.
"""

from __future__ import annotations

from workbench.proof.row import Row, compared
from workbench.proof.validation.contact.finger_record import FINGER, ball_N
from workbench.proof.validation.contact.presses import NAME, finger_press
from workbench.proof.validation.fem import (
    calculix,
    fem_exact,
    fem_limits,
    fem_matrix,
    fem_meshes,
    fem_mpm,
    fem_paths,
    pads,
    sliding_shares,
    tips,
)

LIMIT = 0.05
"""In one step friction costs 2 % of the force of ten, and a grid of a quarter wall reads low."""


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
        *pads.rows(),
        *fem_matrix.recorded_rows(),
        *_recorded(),
        *(calculix.rows() if calculix.installed() else ()),
    ]


def fine_rows() -> list[Row]:
    """Rows that take minutes each."""
    return [*fem_meshes.fine_rows(), *fem_mpm.fine_rows(), *fem_matrix.repeated_rows()]


def _recorded() -> list[Row]:
    """The contact solver beside figures on record."""
    words = f"{NAME}; MPM 0.5 mm in one step against"
    calculix = f"C3D8I of CalculiX on {fem_meshes.FINEST_MM:g} mm hexahedra, patch of 7 mm"
    return [
        compared(
            "finger_45_normal_force",
            f"{words} {mesh}",
            lambda: float(finger_press().normal_N[-1]),
            reference_N,
            unit="N",
            limit=LIMIT,
            null=lambda: float(finger_press(friction=0.0).normal_N[-1]),
            record=record,
        )
        for mesh, reference_N, record in (
            ("FEM extrapolated to edge 0, on record", ball_N, FINGER),
            (calculix, fem_meshes.CALCULIX_N, None),
        )
    ]
