"""A round bar of 7 mm; presses with its flat end."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import head, standing
from workbench.core.objects.plane import Profile

DIAMETER_MM = 7.0


def section(size_mm: float, shrink_mm: float) -> Profile:
    """A circle, shrunk."""
    return lambda place: np.hypot(*place.T) - (0.5 * size_mm - shrink_mm)


KIND = head(
    2,
    size_mm=DIAMETER_MM,
    wide_mm=(0.5 * DIAMETER_MM, 0.5 * DIAMETER_MM),
    distance=standing(section, DIAMETER_MM),
)
