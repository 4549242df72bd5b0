"""A prism with diagonals of 1 and 0.6 `size_mm` along X and Y."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import regular
from workbench.core.objects.prism import polygon_extent, polygonal, prism

SHORT_SHARE = 0.6
"""The short diagonal over the long one."""


def corners_mm(size_mm: float) -> np.ndarray:
    """Of the sharp cross-section, shape (C, 2)."""
    return regular(4, size_mm / 2, 0.0) * [1.0, SHORT_SHARE]


KIND = Kind(
    place=14,
    group=Group.UNSEEN,
    edge_share=0.2,
    distance=prism(polygonal(corners_mm)),
    half_extent_mm=polygon_extent(corners_mm),
)
