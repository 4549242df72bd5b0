"""Contact: closed forms, finite elements, balance and invariances of the contact solver."""

from __future__ import annotations

import functools

from workbench.pipeline.devices import open_device
from workbench.proof.row import Row, compared
from workbench.proof.validation.contact import fingers, invariants, layers, one_number, slips

BACKED_LIMIT = 0.03
"""The closed form is for small strain: neo-Hookean columns without Poisson effect push 2 % more at
4 %, and a plate sinks up to 1 % into the grid's edge."""
SHEARED_LIMIT = 0.03
"""The block also bends, which the closed form leaves out: 2 % here, more on stiffer gel."""


def rows() -> list[Row]:
    """All rows of the room."""
    return [
        *layers.rows(),
        *_backed_block(),
        _sheared_block(),
        *fingers.rows(),
        *slips.rows(),
        *one_number.rows(),
        *invariants.rows(),
    ]


def _backed_block() -> list[Row]:
    from sim.contact.studies import backed

    def force_N(backing_MPa: float) -> float:
        open_device()
        return backed.backed_block_force_N(backing_MPa)

    area_mm2, depth_mm = backed.BACKED_MM**2, backed.BACKED_DEPTH_MM
    return [
        compared(
            "backed_block_force",
            f"block {backed.BACKED_HEIGHT_MM:g} mm on {backed.BACKED_GAP_MM:g} mm of gel of "
            f"{backing_MPa:g} MPa, plate {depth_mm:g} mm deep; null: the gel alone",
            functools.partial(force_N, backing_MPa),
            backed.two_columns_force_N(backing_MPa),
            unit="N",
            limit=BACKED_LIMIT,
            null=area_mm2 * depth_mm * backing_MPa / backed.BACKED_GAP_MM,
        )
        for backing_MPa in backed.BACKINGS_MPa
    ]


def _sheared_block() -> Row:
    from sim.contact.studies import backed

    backing_MPa, shear_mm = backed.SHEARED_BACKING_MPa, backed.BACKED_SHEAR_MM

    def force_N() -> float:
        open_device()
        return backed.backed_block_shear_N(backing_MPa)

    return compared(
        "backed_block_shear",
        f"the same on gel of {backing_MPa:g} MPa, rough plate moved {shear_mm:g} mm sideways; "
        "null: gel as stiff sideways as along its normal",
        force_N,
        backed.two_sheared_columns_force_N(backing_MPa),
        unit="N",
        limit=SHEARED_LIMIT,
        null=backed.two_sheared_columns_force_N(3.0 * backing_MPa),
    )
