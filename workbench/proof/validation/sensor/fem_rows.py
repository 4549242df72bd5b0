"""Fast contact, and the contact solver that it follows, beside finite elements.

Neither was fitted to these: another solver, another mesh, another law of contact. Finite elements
say how far off they are themselves, which is the ceiling of each score: what a flat end presses
with its edge is least certain.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, Unpack

import numpy as np

from workbench.core.base.errors import StoreError
from workbench.proof.row import Bounds, Row, bounded, failed, stated
from workbench.proof.validation.sensor import fem_presses, sensor_figures
from workbench.proof.validation.sensor.spring import spring
from workbench.system.record import Record

FORCE_LIMIT, SHEAR_LIMIT, SLIP_LIMIT = 0.10, 0.10, 0.15
"""Asked of fast contact: of the force, of its peak, of the contact's share."""
DEPTHS_MM = (0.3, 0.6, 1.0)
MPM_FORCE, MPM_SLIP = "full_normal_N", "full_slip"
"""What the record of fast contact calls the contact solver's."""
BESIDE = "beside finite elements"
APART = "largest difference of the share that slides"


def rows(kept: Record = fem_presses.RECORD, played: Record = sensor_figures.RECORD) -> list[Row]:
    """Rows of all presses on both records."""
    try:
        solved, ours = kept.figures()["designs"], played.figures()["designs"]
    except StoreError as error:
        return [failed("fast_fem_force", "presses", unit="1", why=error.message)]
    found: list[Row] = []
    for design, things in solved.items():
        for thing, truth in things.items():
            case = f"{design}, {thing}"
            if thing not in ours.get(design, {}):
                found.append(failed("fast_fem_force", case, unit="1", why="fast contact has none"))
            elif truth["pressed"] != list(fem_presses.PRESSED):
                why = "finite elements solved another press"
                found.append(failed("fast_fem_force", case, unit="1", why=why))
            else:
                found += _rows(case, ours[design][thing], truth, kept)
    return found


def _rows(case: str, ours: dict[str, Any], truth: dict[str, Any], kept: Record) -> Iterator[Row]:
    depth, force = np.array(ours["depth_mm"]), np.array(truth["normal_N"])
    down = len(depth)
    # Without an error of their own, finite elements are of a coarse mesh: compared, no judge.
    judge = bool(truth["error"])
    own = [abs(error) for error in truth["error"]] or [None] * len(force)
    shown = [int(np.abs(depth - depth_mm).argmin()) for depth_mm in DEPTHS_MM]
    off = {name: np.abs(np.array(ours[name]) / force - 1.0) for name in ("normal_N", MPM_FORCE)}
    null = np.abs(spring(depth, force[:down]) * depth / force[:down] - 1.0)
    for number in shown:
        yield _judged(
            "fast_fem_force",
            f"{case}, {depth[number]:g} mm: error of the normal force {BESIDE}",
            float(off["normal_N"][number]),
            limit=FORCE_LIMIT if judge else None,
            null=float(null[number]),
            ceiling=own[number],
            record=kept,
        )
    yield stated(
        "fast_fem_mpm_force",
        f"{case}, {DEPTHS_MM[0]:g} to {DEPTHS_MM[-1]:g} mm: the contact solver's largest {BESIDE}",
        float(off[MPM_FORCE][shown].max()),
        unit="1",
        ceiling=max((own[k] for k in shown if own[k] is not None), default=None),
        record=kept,
    )
    across = np.array(truth["across_N"])[down:]
    sheared = np.array(ours["across_N"])[down:]
    yield _judged(
        "fast_fem_shear",
        f"{case}: largest error of the tangential force over its peak {BESIDE}",
        float(np.abs(sheared - across).max() / across.max()),
        limit=SHEAR_LIMIT if judge else None,
        null=1.0,
        record=kept,
    )
    slip = np.array(truth["slip"])
    far = {name: np.abs(np.array(ours[name]) - slip) for name in ("slip", MPM_SLIP)}
    yield _judged(
        "fast_fem_slip",
        f"{case}, straight: {APART} {BESIDE}; null: all slides",
        float(far["slip"][:down].max()),
        limit=SLIP_LIMIT if judge else None,
        null=float(1.0 - slip[:down].min()),
        record=kept,
    )
    yield stated(
        "fast_fem_mpm_slip",
        f"{case}, straight: the contact solver's {APART} {BESIDE}",
        float(far[MPM_SLIP][:down].max()),
        unit="1",
        record=kept,
    )
    yield stated(
        "fast_fem_slip_sheared",
        f"{case}, sheared: {APART} {BESIDE}",
        float(far["slip"][down:].max()),
        unit="1",
        null=float(np.abs(1.0 - slip[down:]).max()),
        record=kept,
    )


def _judged(
    name: str, case: str, value: float, *, limit: float | None, **bounds: Unpack[Bounds]
) -> Row:
    """A row with a limit, or a stated one without."""
    if limit is None:
        return stated(name, f"{case}, a coarse mesh", value, unit="1", **bounds)
    return bounded(name, case, value, unit="1", limit=limit, **bounds)
