"""A disc of diameter `size_mm` with a mouth of 60 degrees toward +X, extruded."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import Profile, arc, segment, turn
from workbench.core.objects.prism import prism

MOUTH_HALF_ANGLE = np.pi / 6


def section(size_mm: float, shrink_mm: float) -> Profile:
    """The cross-section, shrunk."""
    radius = 0.5 * size_mm - shrink_mm
    apex = np.array([-shrink_mm / np.sin(MOUTH_HALF_ANGLE), 0.0])
    lip = np.array([np.cos(MOUTH_HALF_ANGLE), np.sin(MOUTH_HALF_ANGLE)])
    along = -apex @ lip + np.sqrt((apex @ lip) ** 2 + radius**2 - apex @ apex)
    corner = apex + along * lip
    half = np.pi - np.arctan2(corner[1], corner[0])

    def distance(place: np.ndarray) -> np.ndarray:
        upper = np.stack([place[:, 0], np.abs(place[:, 1])], axis=1)
        jaw = segment(upper, apex, corner)
        unsigned = np.minimum(jaw, arc(upper, np.zeros(2), radius, np.pi, half))
        in_mouth = turn(lip, upper - apex) < 0.0
        inside = (np.linalg.norm(place, axis=1) < radius) & ~in_mouth
        return np.where(inside, -unsigned, unsigned)

    return distance


KIND = Kind(
    place=3,
    group=Group.SEEN,
    aliases=("pac-man",),
    edge_share=0.2,
    distance=prism(section),
)
