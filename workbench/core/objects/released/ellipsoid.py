"""A bar whose section is an ellipse of 8 x 4 mm; presses with its flat end."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import head, standing
from workbench.core.objects.plane import Profile, ellipse_arc

SEMI_MM = (4.0, 2.0)


def section(size_mm: float, shrink_mm: float) -> Profile:
    """The ellipse. It is rounder than any edge, so shrinking only adds to the distance."""
    long, short = 0.5 * size_mm, 0.5 * size_mm * SEMI_MM[1] / SEMI_MM[0]

    def distance(place: np.ndarray) -> np.ndarray:
        unsigned = ellipse_arc(np.abs(place), (long, short))
        inside = np.hypot(place[:, 0] / long, place[:, 1] / short) < 1.0
        return np.where(inside, -unsigned, unsigned) + shrink_mm

    return distance


KIND = head(
    6,
    size_mm=2.0 * SEMI_MM[0],
    wide_mm=SEMI_MM,
    distance=standing(section, 2.0 * SEMI_MM[0]),
    edge_share=0.12,
)
