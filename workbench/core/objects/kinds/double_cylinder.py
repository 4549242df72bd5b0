"""Two upright cylinders of diameter 0.45 `size_mm` with 0.1 between them along X."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import Profile
from workbench.core.objects.prism import prism

WIDTH_SHARE = 0.45
"""Diameter of a pin over the size."""


def section(size_mm: float, shrink_mm: float) -> Profile:
    """The cross-section, shrunk."""
    radius = 0.5 * WIDTH_SHARE * size_mm
    centre = 0.5 * size_mm - radius
    return lambda place: np.hypot(np.abs(place[:, 0]) - centre, place[:, 1]) - (radius - shrink_mm)


KIND = Kind(place=6, group=Group.SEEN, edge_share=0.2, distance=prism(section))
