"""Five round petals in a circle of diameter `size_mm`, one toward +X, extruded."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import Profile, arc
from workbench.core.objects.prism import prism

PETALS = 5
PETAL_RADIUS = 0.19
"""Radius of a petal over the size; neighbours overlap, as 0.19 > 0.31 sin(36 degrees)."""


def section(size_mm: float, shrink_mm: float) -> Profile:
    """The petals' outer arcs. It has no convex corner, so shrinking only adds to the distance."""
    radius, sector = PETAL_RADIUS * size_mm, np.pi / PETALS
    centre = np.array([0.5 * size_mm - radius, 0.0])
    notch_mm = float(
        centre[0] * np.cos(sector) + np.sqrt(radius**2 - (centre[0] * np.sin(sector)) ** 2)
    )
    notch = notch_mm * np.array([np.cos(sector), np.sin(sector)])
    half = float(np.arctan2(notch[1], notch[0] - centre[0]))

    def distance(place: np.ndarray) -> np.ndarray:
        rho = np.hypot(*place.T)
        # Turned into the sector of the petal toward +X, whose arc is then the nearest.
        angle = np.arctan2(place[:, 1], place[:, 0])
        angle -= 2.0 * sector * np.round(angle / (2.0 * sector))
        turned = rho[:, None] * np.stack([np.cos(angle), np.abs(np.sin(angle))], axis=1)
        unsigned = arc(turned, centre, radius, 0.0, half)
        in_petal = np.linalg.norm(turned - centre, axis=1) < radius
        inside = in_petal | (turned[:, 0] < notch[0])
        return np.where(inside, -unsigned, unsigned) + shrink_mm

    return distance


KIND = Kind(place=12, group=Group.UNSEEN, edge_share=0.15, distance=prism(section))
