"""A disc of diameter `size_mm` with a mouth of 60 degrees toward +X, extruded."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import Profile, bitten
from workbench.core.objects.prism import prism

MOUTH_HALF_ANGLE = np.pi / 6


def section(size_mm: float, shrink_mm: float) -> Profile:
    """The cross-section, shrunk."""
    return bitten(0.5 * size_mm, MOUTH_HALF_ANGLE, shrink_mm)


KIND = Kind(
    place=3,
    group=Group.SEEN,
    aliases=("pac-man",),
    edge_share=0.2,
    distance=prism(section),
)
