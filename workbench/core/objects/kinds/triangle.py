"""An equilateral prism of side `size_mm`, a corner toward +Y."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.plane import regular
from workbench.core.objects.prism import polygon_extent, polygonal, prism


def corners_mm(size_mm: float) -> np.ndarray:
    """Of the sharp cross-section, shape (C, 2)."""
    return regular(3, size_mm / 3**0.5, np.pi / 2)


KIND = Kind(
    place=2,
    group=Group.SEEN,
    edge_share=0.2,
    distance=prism(polygonal(corners_mm)),
    half_extent_mm=polygon_extent(corners_mm),
)
