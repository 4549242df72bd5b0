"""Forces: invariances that hold exactly for the true solution, and learned forces.

Statics is linear in E, does not know the azimuth of an axisymmetric finger, mirrors with it, and a
frictionless sphere cannot be turned about its centre. `learned` has the rows of learned forces.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from workbench.proof.row import Row, bounded, compared
from workbench.proof.validation.contact.finger_record import FINGER, sheared_N
from workbench.proof.validation.contact.presses import finger_press
from workbench.proof.validation.learned import room as learned

ROTATION_LIMIT = 0.02
"""The grid is not isotropic; a quarter-wall grid scatters the force by about 1 %."""
SETTLED = 5e-3
"""Frames settle to a residual of 1e-3; two of them differ by a few times that."""
SHEAR_MM = (0.0, 0.5)
SHEAR_LIMIT = 0.1
"""A grid of a quarter wall and one frame of shear read up to 7 % low."""


def rows(data: Path | None = None) -> list[Row]:
    """All rows of the room: invariances of the contact solver, then learned forces.

    Args:
        data: Data set to score learned forces on; None: the held-out sets that ship.
    """
    return [*invariances(), *learned.rows(data)]


def invariances() -> list[Row]:
    """The rows of the contact solver."""
    found = [
        compared(
            "stiffness_tripled",
            "force at 3 E over force at E",
            lambda: _force_N(young_MPa=0.435) / _force_N(),
            3.0,
            unit="1",
            limit=SETTLED,
            null=1.0,
        ),
        bounded("mirror", "azimuth 180 against 0", _mirror_error, unit="1", limit=SETTLED),
        bounded(
            "moment_of_smooth_sphere",
            "moment about its centre over force times radius",
            _lever,
            unit="1",
            limit=0.01,
        ),
        bounded(
            "friction_cone",
            "largest pointwise tangential over normal force, mu 0.3, sheared 0.5 mm",
            lambda: float(finger_press(shear_mm=SHEAR_MM).friction_ratio.max()),
            unit="1",
            limit=0.3 * (1 + 1e-4),
        ),
        compared(
            "shear_force",
            "tangential force at 0.5 mm of shear along V, against FEM on the finest mesh on record",
            _shear_force_N,
            sheared_N,
            unit="N",
            limit=SHEAR_LIMIT,
            record=FINGER,
            null=0.0,
        ),
    ]
    found += [
        compared(
            "rotation",
            f"azimuth {azimuth_deg:g} against 0 degrees",
            lambda azimuth_deg=azimuth_deg: _force_N(azimuth_deg=azimuth_deg),
            _force_N,
            unit="N",
            limit=ROTATION_LIMIT,
        )
        for azimuth_deg in (22.5, 37.0)
    ]
    return found


def _force_N(*, azimuth_deg: float = 0.0, young_MPa: float = 0.145) -> float:
    return float(finger_press(azimuth_deg=azimuth_deg, young_MPa=young_MPa).normal_N[-1])


def _mirror_error() -> float:
    """Distance of the mirrored reaction from the other one, over the force [1]."""
    mirrored = finger_press(azimuth_deg=180.0).reaction_N[-1] * [-1.0, 1.0, 1.0]
    return float(np.linalg.norm(mirrored - finger_press().reaction_N[-1])) / _force_N()


def _lever() -> float:
    """Moment of a smooth sphere about its centre, over force times radius [1]."""
    smooth = finger_press(friction=0.0)
    return float(np.linalg.norm(smooth.moment_Nmm[-1]) / (3.0 * smooth.normal_N[-1]))


def _shear_force_N() -> float:
    """Tangential force that resists a shear along V [N]."""
    sheared = finger_press(shear_mm=SHEAR_MM)
    return -float(sheared.reaction_N[-1] @ np.cross(sheared.normal, sheared.tangent_u))
