"""A three-sided bar of 4.7 x 5.3 mm, a corner toward -X, corners round by 0.5 mm."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import head, standing
from workbench.core.objects.plane import Profile, inset, polygon, regular

ROUND_MM = 0.5
CORE_MM = 2.4641
"""From the middle of the triangle to the centre of a rounding."""
MIDDLE_MM = 0.268
"""Middle of the triangle along X: its flat side stands 2 mm from the axis."""
HALF_WIDE_MM = CORE_MM * 0.75**0.5 + ROUND_MM
LONGEST_MM = CORE_MM + ROUND_MM - MIDDLE_MM


def section(size_mm: float, shrink_mm: float) -> Profile:
    """A smaller triangle, and its rounding."""
    scale = 0.5 * size_mm / HALF_WIDE_MM
    round_mm = max(ROUND_MM * scale - shrink_mm, 0.0)
    core = regular(3, CORE_MM * scale, np.pi) + np.array([MIDDLE_MM * scale, 0.0])
    core = inset(core, max(shrink_mm - ROUND_MM * scale, 0.0))
    return lambda place: polygon(place, core) - round_mm


KIND = head(
    13,
    size_mm=2.0 * HALF_WIDE_MM,
    wide_mm=(LONGEST_MM, HALF_WIDE_MM),
    distance=standing(section, 2.0 * HALF_WIDE_MM),
)
