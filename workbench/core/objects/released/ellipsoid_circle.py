"""A bar of 6 x 8 mm: half a circle toward -X, half an ellipse toward +X; presses with its end."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import head, standing
from workbench.core.objects.plane import Profile, arc, ellipse_arc

RADIUS_MM, SHORT_MM = 4.0, 2.0
"""Of the circle, and the short half axis of the ellipse; its long one is the radius."""


def section(size_mm: float, shrink_mm: float) -> Profile:
    """Both halves. They are rounder than any edge, so shrinking only adds to the distance."""
    radius, short = 0.5 * size_mm, 0.5 * size_mm * SHORT_MM / RADIUS_MM

    def distance(place: np.ndarray) -> np.ndarray:
        upper = np.stack([place[:, 0], np.abs(place[:, 1])], axis=1)
        half_circle = arc(place, np.zeros(2), radius, np.pi, 0.5 * np.pi)
        unsigned = np.minimum(half_circle, ellipse_arc(upper, (short, radius)))
        reach = np.where(place[:, 0] < 0.0, radius, short)
        inside = np.hypot(place[:, 0] / reach, place[:, 1] / radius) < 1.0
        return np.where(inside, -unsigned, unsigned) + shrink_mm

    return distance


KIND = head(
    7,
    size_mm=2.0 * RADIUS_MM,
    wide_mm=(RADIUS_MM, RADIUS_MM),
    distance=standing(section, 2.0 * RADIUS_MM),
    edge_share=0.12,
)
