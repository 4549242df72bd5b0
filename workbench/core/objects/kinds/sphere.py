"""A ball of diameter `size_mm`."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind, Shape, half_of


def numbers(size_mm: float, edge_mm: float) -> np.ndarray:
    """The radius."""
    return np.array([0.5 * size_mm, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])


KIND = Kind(
    place=10,
    group=Group.SEEN,
    edge_share=None,
    sharpest_mm=half_of,
    shape=Shape.SPHERE,
    numbers=numbers,
)
