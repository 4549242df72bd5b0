"""Fast contact: what `wb.Sensor` says of presses, beside the contact solver that it was fitted to.

Both are the product's own, so rows say how much the quick way loses, not how true the slow one is.
Null of a force: k times the depth, with the k that suits the object best.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from sim.condensed.lessons import KINDS
from workbench.core.base.errors import StoreError
from workbench.proof.row import Row, bounded, failed, stated
from workbench.proof.validation.sensor import fem_rows, sensor_figures
from workbench.proof.validation.sensor.spring import spring
from workbench.system.record import Record

FITTED_LIMIT, OTHER_LIMIT = 0.06, 0.10
"""Error of the normal force of kinds whose presses were fitted, and of others."""
SHEAR_LIMIT, TORQUE_LIMIT, ANGLE_LIMIT_DEG = 0.10, 0.15, 5.0
SLIP_LIMIT = 0.10
"""Of force here, of area in the contact solver."""
HALF_MM, HALF_LIMIT, WHOLE_LIMIT = 0.5, 0.97, 0.96
"""SSIM asked up to this depth, and beyond."""
FROM_MM = 0.2
"""Depth from which forces are judged."""


def rows(kept: Record = sensor_figures.RECORD) -> list[Row]:
    """All rows of the room."""
    return [*contact_rows(kept), *fem_rows.rows(played=kept)]


def contact_rows(kept: Record) -> list[Row]:
    """Rows beside the contact solver."""
    try:
        designs = kept.figures()["designs"]
    except StoreError as error:
        return [failed("fast_force", "presses", unit="1", why=error.message)]
    return [
        row
        for design, things in designs.items()
        for thing, figures in things.items()
        if thing != "fit"
        for row in (
            _slid_rows(design, figures, kept)
            if thing == sensor_figures.SLIDE
            else _rows(f"{design}, {thing}", figures, (thing, kept))
        )
    ]


def _rows(case: str, figures: dict[str, Any], of: tuple[str, Record]) -> Iterator[Row]:
    thing, kept = of
    depth = np.array(figures["depth_mm"])
    down = len(depth)
    force, full = np.array(figures["normal_N"]), np.array(figures["full_normal_N"])
    best = spring(depth, full[:down])
    fitted = thing in list(KINDS)
    limit = FITTED_LIMIT if fitted else OTHER_LIMIT
    words = "fitted" if fitted else "left out of the fit"
    for number in np.flatnonzero(depth >= FROM_MM - 1e-9):
        yield bounded(
            "fast_force",
            f"{case}, {depth[number]:g} mm: error of the normal force, {words}",
            abs(force[number] / full[number] - 1.0),
            unit="1",
            limit=limit,
            null=abs(best * depth[number] / full[number] - 1.0),
            record=kept,
        )
    across, side = np.array(figures["across_N"]), np.array(figures["full_across_N"])
    peak = side.max()
    yield bounded(
        "fast_shear",
        f"{case}, {depth[-1]:g} mm: largest error of the tangential force over its peak",
        float(np.abs(across - side)[down:].max() / peak),
        unit="1",
        limit=SHEAR_LIMIT,
        null=1.0,
        record=kept,
    )
    yield bounded(
        "fast_direction",
        f"{case}, {depth[-1]:g} mm: largest angle between the forces",
        figures["worst_angle_deg"],
        unit="degree",
        limit=ANGLE_LIMIT_DEG,
        null=float(np.degrees(np.arctan2(side, full)).max()),
        record=kept,
    )
    yield bounded(
        "fast_torque",
        f"{case}, {depth[-1]:g} mm: error of the torque after shear; null: none",
        figures["torque_error"],
        unit="1",
        limit=TORQUE_LIMIT,
        null=1.0,
        record=kept,
    )
    slips, full_slips = np.array(figures["slip"]), np.array(figures["full_slip"])
    apart = np.abs(slips - full_slips)
    yield bounded(
        "fast_slip",
        f"{case}, straight: largest difference of the share that slides; null: all slides",
        float(apart[:down].max()),
        unit="1",
        limit=SLIP_LIMIT,
        null=float(1.0 - full_slips[:down].min()),
        record=kept,
    )
    yield stated(
        "fast_slip_sheared",
        f"{case}, {depth[-1]:g} mm, sheared: largest difference of the share that slides",
        float(apart[down:].max()),
        unit="1",
        null=float(np.abs(1.0 - full_slips[down:]).max()),
        record=kept,
    )
    for number, score in figures["ssim"].items():
        yield bounded(
            "fast_image",
            f"{case}, {depth[int(number) - 1]:g} mm: SSIM where the image changes; null: no dent",
            score,
            unit="1",
            limit=HALF_LIMIT if depth[int(number) - 1] <= HALF_MM else WHOLE_LIMIT,
            sense="min",
            null=figures["null_ssim"][number],
            record=kept,
        )
    yield stated(
        "fast_noted",
        f"{case}: frames of {len(force)} that the sensor says are beyond its range",
        figures["noted"],
        unit="1",
        record=kept,
    )


def _slid_rows(design: str, figures: dict[str, Any], kept: Record) -> Iterator[Row]:
    across, full = np.array(figures["across_N"]), np.array(figures["full_across_N"])
    yield bounded(
        "fast_slide",
        f"{design}, sphere, slides {sensor_figures.SLIDE_MM:g} mm and back: largest error of the "
        "tangential force over its peak",
        float(np.linalg.norm(across - full, axis=1).max() / np.linalg.norm(full, axis=1).max()),
        unit="1",
        limit=SHEAR_LIMIT,
        null=1.0,
        record=kept,
    )
