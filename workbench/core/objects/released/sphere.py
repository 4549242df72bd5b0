"""A ball of 6 mm on a neck of 3 mm."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import LENGTH_MM, head
from workbench.core.objects.kind import Distance
from workbench.core.objects.plane import meet

DIAMETER_MM, NECK_MM = 6.0, 3.0


def distance(size_mm: float, edge_mm: float) -> Distance:
    """The ball, or the neck, whichever is nearer; only the far end of the neck has an edge."""
    radius, scale = 0.5 * size_mm, size_mm / DIAMETER_MM
    neck, top = 0.5 * NECK_MM * scale, 0.5 * LENGTH_MM * scale
    middle = radius - top

    def to_head(place: np.ndarray) -> np.ndarray:
        rho, above = np.hypot(place[:, 0], place[:, 1]), place[:, 2] - middle
        # The neck begins in the middle of the ball, so that it has no lower end outside it.
        along = np.maximum(place[:, 2] - (top - edge_mm), (middle + edge_mm) - place[:, 2])
        bar = meet(rho - (neck - edge_mm), along) - edge_mm
        return np.minimum(np.hypot(rho, above) - radius, bar)

    return to_head


KIND = head(
    11, size_mm=DIAMETER_MM, wide_mm=(0.5 * DIAMETER_MM, 0.5 * DIAMETER_MM), distance=distance
)
