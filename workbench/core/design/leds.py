"""Where LEDs sit: the one circle that light, housing and parts list share, and lamps as points.

p_k = r (cos a_k, sin a_k, 0) + h z with a_k = phase + k 360 / count; the emission axis is +Z tilted
outward. `colour_sectors` says which has which colour. A line or an area of light is divided into
equal cells with a point in the middle of each; the housing and the parts list leave lamps out.
"""

from __future__ import annotations

import numpy as np

from workbench.core.base.units import radians
from workbench.core.design.lighting import Lamp, LampKind, LedRing


def led_places(ring: LedRing) -> tuple[np.ndarray, np.ndarray]:
    """Positions [mm] and unit emission axes of the LEDs, shape (L, 3) each, float64."""
    azimuth = radians(ring.phase_deg) + np.arange(ring.count) * (2 * np.pi / max(ring.count, 1))
    outward = np.column_stack([np.cos(azimuth), np.sin(azimuth), np.zeros(ring.count)])
    up = np.array([0.0, 0.0, 1.0])
    tilt = radians(ring.tilt_deg)
    places = ring.radius_mm * outward + ring.height_mm * up
    return places, np.cos(tilt) * up + np.sin(tilt) * outward


def colour_sectors(ring: LedRing) -> np.ndarray:
    """Row of `ring.colours` of each LED, shape (L,): equal sectors in the order of azimuth."""
    return np.arange(ring.count) * len(ring.colours) // max(ring.count, 1)


def lamp_points(lamp: Lamp) -> tuple[np.ndarray, np.ndarray]:
    """Positions [mm] and unit emission axes of a lamp's points, shape (`lamp.points`, 3) each."""
    axis = np.asarray(lamp.axis) / np.linalg.norm(lamp.axis)
    along = np.asarray(lamp.along) / np.linalg.norm(lamp.along)
    if lamp.kind is LampKind.AREA:
        # A rectangle shines square to itself, so its length turns into the plane across the axis.
        along = along - (along @ axis) * axis
        along = along / np.linalg.norm(along)
    columns, rows = lamp.grid
    step = (np.arange(columns) + 0.5) / columns - 0.5
    side = (np.arange(rows) + 0.5) / rows - 0.5
    u, v = (each.ravel() for each in np.meshgrid(step * lamp.length_mm, side * lamp.width_mm))
    if lamp.kind is not LampKind.AREA:
        v = np.zeros_like(v)
    if lamp.kind is LampKind.POINT:
        u = np.zeros_like(u)
    across = np.cross(axis, along)
    places = np.asarray(lamp.position_mm) + u[:, None] * along + v[:, None] * across
    return places, np.tile(axis, (len(places), 1))


def lamp_cell_mm(lamp: Lamp) -> float:
    """Diameter [mm] of the disc that each point stands for.

    A point's own; of a line the length of a part, of an area that of a disc as large as a cell.
    """
    columns, rows = lamp.grid
    if lamp.kind is LampKind.POINT:
        return lamp.size_mm
    if lamp.kind is LampKind.LINE:
        return lamp.length_mm / columns
    cell_mm2 = lamp.length_mm * lamp.width_mm / (columns * rows)
    return 2.0 * float(np.sqrt(cell_mm2 / np.pi))
