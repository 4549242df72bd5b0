"""Contact: closed forms, balance and penetration of the contact solver."""

from __future__ import annotations

import functools
import math

import numpy as np

from workbench.core.design import Elastomer
from workbench.core.press import ContactSettings
from workbench.devices import open_device
from workbench.outputs import force_balance
from workbench.rows import Row, bounded, compared
from workbench.validation.presses import NAME, finger_press

CELLS_PER_CONTACT_RADIUS = 4.0
BLOCK_LIMIT = 0.07
BACKED_LIMIT = 0.03
"""The closed form is for small strain: neo-Hookean columns without Poisson effect push 2 % more at
4 %, and a plate sinks up to 1 % into the grid's edge."""
SHEARED_LIMIT = 0.03
"""The block also bends, which the closed form leaves out: 2 % here, more on stiffer gel."""
PENETRATION_LIMIT_CELLS = 0.02
BALANCE_LIMIT = 0.01
WIDE_REGION_MM = 18.0
"""Wide enough that next to nothing is left to the elastomer beyond it."""
FINGER_RANGE_N = (1.20, 1.35)


def rows() -> list[Row]:
    """All rows of the room."""
    return [*_bonded_block(), *_backed_block(), _sheared_block(), *_finger()]


def _bonded_block() -> list[Row]:
    from sim.contact import checks

    radius_mm = checks.BLOCK_SPHERE_MM / 2
    # The contact radius of a bonded layer is at least Hertz's sqrt(R d), least at the least depth.
    least_mm = math.sqrt(radius_mm * min(checks.BLOCK_DEPTHS_MM))
    grid_mm = math.floor(1000 * least_mm / CELLS_PER_CONTACT_RADIUS) / 1000
    material = Elastomer(friction=0.0)

    @functools.cache
    def errors() -> tuple[float, ...]:
        open_device()
        return tuple(float(error) for error in checks.bonded_block_errors(grid_mm=grid_mm))

    found = []
    for number, depth_mm in enumerate(checks.BLOCK_DEPTHS_MM):
        exact_N = checks.bonded_layer_force_N(
            material,
            radius_mm=radius_mm,
            height_mm=checks.BLOCK_HEIGHT_MM,
            depth_mm=depth_mm,
        )
        half_space_N = (
            4 / 3 * material.young_MPa / (1 - material.poisson**2) * math.sqrt(radius_mm)
        ) * depth_mm**1.5
        found.append(
            compared(
                "bonded_block_force",
                f"depth {depth_mm:g} mm, sphere R {radius_mm:g} on {checks.BLOCK_HEIGHT_MM:g} mm, "
                f"dx {grid_mm:g} mm <= a/4, frictionless; null: Hertz half-space",
                lambda exact_N=exact_N, number=number: exact_N * (1.0 + errors()[number]),
                exact_N,
                unit="N",
                limit=BLOCK_LIMIT,
                null=half_space_N,
            )
        )
    return found


def _backed_block() -> list[Row]:
    from sim.contact import checks

    def force_N(backing_MPa: float) -> float:
        open_device()
        return checks.backed_block_force_N(backing_MPa)

    area_mm2, depth_mm = checks.BACKED_MM**2, checks.BACKED_DEPTH_MM
    return [
        compared(
            "backed_block_force",
            f"block {checks.BACKED_HEIGHT_MM:g} mm on {checks.BACKED_GAP_MM:g} mm of gel of "
            f"{backing_MPa:g} MPa, plate {depth_mm:g} mm deep; null: the gel alone",
            functools.partial(force_N, backing_MPa),
            checks.two_columns_force_N(backing_MPa),
            unit="N",
            limit=BACKED_LIMIT,
            null=area_mm2 * depth_mm * backing_MPa / checks.BACKED_GAP_MM,
        )
        for backing_MPa in checks.BACKINGS_MPa
    ]


def _sheared_block() -> Row:
    from sim.contact import checks

    backing_MPa, shear_mm = checks.SHEARED_BACKING_MPa, checks.BACKED_SHEAR_MM

    def force_N() -> float:
        open_device()
        return checks.backed_block_shear_N(backing_MPa)

    return compared(
        "backed_block_shear",
        f"the same on gel of {backing_MPa:g} MPa, rough plate moved {shear_mm:g} mm sideways; "
        "null: gel as stiff sideways as along its normal",
        force_N,
        checks.two_sheared_columns_force_N(backing_MPa),
        unit="N",
        limit=SHEARED_LIMIT,
        null=checks.two_sheared_columns_force_N(3.0 * backing_MPa),
    )


def _finger() -> list[Row]:
    penalty = ContactSettings().penalty
    low_N, high_N = FINGER_RANGE_N
    middle_N = (low_N + high_N) / 2
    return [
        bounded(
            "penetration",
            f"{NAME}; penalty {penalty:g} E/dx",
            lambda: float(finger_press().penetration_mm.max()) / finger_press().grid_mm,
            unit="cell",
            limit=PENETRATION_LIMIT_CELLS,
        ),
        bounded(
            "force_balance",
            f"{NAME}; 12 mm region: reaction against support and left-out elastomer",
            lambda: force_balance(finger_press()),
            unit="1",
            limit=BALANCE_LIMIT,
        ),
        bounded(
            "force_balance",
            f"{NAME}; {WIDE_REGION_MM:g} mm region: reaction against the support alone",
            _wide_balance,
            unit="1",
            limit=BALANCE_LIMIT,
        ),
        bounded(
            "residual", NAME, lambda: float(finger_press().residual.max()), unit="1", limit=1e-3
        ),
        compared(
            "finger_45",
            f"{NAME}; 12 mm region, 0.5 mm grid; accepted {low_N:g} to {high_N:g} N",
            lambda: float(finger_press().normal_N[-1]),
            middle_N,
            unit="N",
            limit=high_N - middle_N + 1e-12,
            relative=False,
        ),
    ]


def _wide_balance() -> float:
    contact = finger_press(region_mm=WIDE_REGION_MM)
    reaction_N, support_N = contact.reaction_N[-1], contact.support_N[-1]
    return float(np.linalg.norm(reaction_N - support_N) / np.linalg.norm(reaction_N))
