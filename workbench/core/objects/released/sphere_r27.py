"""A square bar of 12 x 12 mm whose end is part of a ball of radius 27 mm."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import LENGTH_MM, head
from workbench.core.objects.kind import Distance
from workbench.core.objects.plane import arc, meet

WIDE_MM, RADIUS_MM = 12.0, 27.0


def distance(size_mm: float, edge_mm: float) -> Distance:
    """A column with a round lower end, cut off above; both shrunk."""
    scale = size_mm / WIDE_MM
    half, radius = 0.5 * size_mm - edge_mm, RADIUS_MM * scale - edge_mm
    top = 0.5 * LENGTH_MM * scale
    middle = RADIUS_MM * scale - top

    def to_head(place: np.ndarray) -> np.ndarray:
        column = _column(place - [0.0, 0.0, middle], half, radius)
        return meet(column, place[:, 2] - (top - edge_mm)) - edge_mm

    return to_head


def _column(place: np.ndarray, half: float, radius: float) -> np.ndarray:
    """Distance to |x|, |y| <= half above the ball about the origin; the least over its parts."""
    wide: np.ndarray = np.sort(np.abs(place[:, :2]), axis=1)
    less, more, z = wide[:, 0], wide[:, 1], place[:, 2]
    rho = np.linalg.norm(place, axis=1)
    low = z < 0.0
    foot = np.where(rho > 0.0, radius / np.maximum(rho, 1e-12), np.inf)
    end = np.where(low & (more * foot <= half), np.abs(rho - radius), np.inf)
    rim = float(np.sqrt(radius**2 - half**2))
    edges = [
        np.hypot(one - half, arc(np.stack([z, other], axis=1), np.zeros(2), rim, np.pi, span))
        for span in [float(np.arcsin(half / rim))]
        for one, other in ((more, less), (less, more))
    ]
    below = low & (np.hypot(z, less) > rim)
    side = np.where(below | (less > half), np.inf, np.abs(more - half))
    beyond = low & (z * z > rim**2 - half**2)
    corner = np.where(beyond, np.inf, np.hypot(more - half, less - half))
    unsigned: np.ndarray = np.minimum.reduce([end, *edges, side, corner])
    inside = (more < half) & ((rho < radius) | ~low)
    return unsigned * np.where(inside, -1.0, 1.0)


KIND = head(12, size_mm=WIDE_MM, wide_mm=(0.5 * WIDE_MM, 0.5 * WIDE_MM), distance=distance)
