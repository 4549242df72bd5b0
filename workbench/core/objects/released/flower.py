"""A bar of four round petals of 4 mm, 8 x 8 mm in all; presses with its end."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import head, standing
from workbench.core.objects.plane import Profile, arc

PETAL_MM = 2.0
"""Radius of a petal, and how far its centre lies from both planes of symmetry."""


def section(size_mm: float, shrink_mm: float) -> Profile:
    """Petals and what they enclose. It has no convex corner, so shrinking adds to the distance."""
    radius = 0.25 * size_mm
    centre = np.array([radius, radius])

    def distance(place: np.ndarray) -> np.ndarray:
        quarter = np.abs(place)
        unsigned = arc(quarter, centre, radius, 0.25 * np.pi, 0.75 * np.pi)
        in_petal = np.linalg.norm(quarter - centre, axis=1) < radius
        inside = in_petal | (quarter < radius).all(axis=1)
        return np.where(inside, -unsigned, unsigned) + shrink_mm

    return distance


KIND = head(
    8,
    size_mm=4.0 * PETAL_MM,
    wide_mm=(2.0 * PETAL_MM, 2.0 * PETAL_MM),
    distance=standing(section, 4.0 * PETAL_MM),
)
