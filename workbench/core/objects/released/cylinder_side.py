"""A cylinder of 4 mm that lies along X, 6 mm long, with a bar of its width behind it."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import LENGTH_MM, head
from workbench.core.objects.plane import Profile, meet
from workbench.core.objects.prism import lying

LONG_MM, RADIUS_MM = 6.0, 2.0


def section(size_mm: float, shrink_mm: float) -> Profile:
    """Half a circle below, straight sides up to the block; places (y, z), shrunk."""
    scale = size_mm / LONG_MM
    radius, top = RADIUS_MM * scale - shrink_mm, 0.5 * LENGTH_MM * scale
    middle = RADIUS_MM * scale - top

    def distance(place: np.ndarray) -> np.ndarray:
        y, z = place.T
        bar = np.hypot(y, np.minimum(z - middle, 0.0)) - radius
        return meet(bar, z - (top - shrink_mm))

    return distance


KIND = head(
    3, size_mm=LONG_MM, wide_mm=(0.5 * LONG_MM, RADIUS_MM), distance=lying(section, length=1.0)
)
