"""A tube of outer diameter `size_mm` and wall 0.25 `size_mm`; presses with its end."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import Profile
from workbench.core.objects.prism import prism

WALL_SHARE = 0.25
"""Wall over the outer diameter."""


def section(size_mm: float, shrink_mm: float) -> Profile:
    """The cross-section, shrunk."""
    wall = WALL_SHARE * size_mm
    middle = 0.5 * (size_mm - wall)
    return lambda place: np.abs(np.hypot(*place.T) - middle) - (0.5 * wall - shrink_mm)


KIND = Kind(place=13, group=Group.UNSEEN, edge_share=0.12, distance=prism(section))
