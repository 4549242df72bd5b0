"""Two cylinders of 3 mm that lie side by side along X, 6 mm long, with a bar behind them."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import LENGTH_MM, head
from workbench.core.objects.plane import Profile, arc, meet
from workbench.core.objects.prism import lying

LONG_MM, RADIUS_MM = 6.0, 1.5


def section(size_mm: float, shrink_mm: float) -> Profile:
    """Two half circles below, straight sides up to the block; places (y, z), shrunk."""
    scale = size_mm / LONG_MM
    radius, top = RADIUS_MM * scale, 0.5 * LENGTH_MM * scale
    centre = np.array([radius, radius - top])

    def distance(place: np.ndarray) -> np.ndarray:
        half = np.stack([np.abs(place[:, 0]), place[:, 1]], axis=1)
        beside, above = half[:, 0] - 2.0 * radius, half[:, 1] > centre[1]
        round_end = arc(half, centre, radius, -0.5 * np.pi, 0.5 * np.pi)
        side = np.where(above, np.abs(beside), np.inf)
        in_end = np.linalg.norm(half - centre, axis=1) < radius
        unsigned = np.minimum(round_end, side)
        bar = np.where(in_end | (above & (beside < 0.0)), -unsigned, unsigned)
        # Below it has no convex corner, so shrinking only adds to the distance.
        return meet(bar + shrink_mm, place[:, 1] - (top - shrink_mm))

    return distance


KIND = head(
    5,
    size_mm=LONG_MM,
    wide_mm=(0.5 * LONG_MM, 2.0 * RADIUS_MM),
    distance=lying(section, length=1.0),
)
