"""A round bar of 6 mm with a mouth of 70 degrees toward -Y; presses with its end."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.head import head, standing
from workbench.core.objects.plane import Profile, bitten

DIAMETER_MM = 6.0
MOUTH_HALF_ANGLE = float(np.radians(35.0))


def section(size_mm: float, shrink_mm: float) -> Profile:
    """The cross-section, shrunk."""
    toward_x = bitten(0.5 * size_mm, MOUTH_HALF_ANGLE, shrink_mm)
    return lambda place: toward_x(np.stack([-place[:, 1], place[:, 0]], axis=1))


KIND = head(
    10,
    size_mm=DIAMETER_MM,
    wide_mm=(0.5 * DIAMETER_MM, 0.5 * DIAMETER_MM),
    distance=standing(section, DIAMETER_MM),
)
