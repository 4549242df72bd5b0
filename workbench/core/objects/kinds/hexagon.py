"""A regular prism, `size_mm` from corner to corner along X."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import regular
from workbench.core.objects.prism import polygon_extent, polygonal, prism


def corners_mm(size_mm: float) -> np.ndarray:
    """Of the sharp cross-section, shape (C, 2)."""
    return regular(6, size_mm / 2, 0.0)


KIND = Kind(
    place=4,
    group=Group.SEEN,
    distance=prism(polygonal(corners_mm)),
    half_extent_mm=polygon_extent(corners_mm),
)
