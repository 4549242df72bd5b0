"""The letter X: a prism of two bars `size_mm` long and 0.3 wide, at 45 degrees to X and Y."""

from __future__ import annotations

import numpy as np

from workbench.core.objects.kind import Group, Kind
from workbench.core.objects.prism import polygon_extent, polygonal, prism

BAR_SHARE = 0.3
"""Width of a bar over its length."""


def corners_mm(size_mm: float) -> np.ndarray:
    """Of the sharp cross-section, shape (C, 2)."""
    long, wide = 0.5 * size_mm, 0.5 * BAR_SHARE * size_mm
    quarter = np.array([[long, -wide], [long, wide], [wide, wide]])
    turns = [np.array([[c, -s], [s, c]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    upright = np.concatenate([quarter @ turn.T for turn in turns])
    return upright @ (np.array([[1.0, 1.0], [-1.0, 1.0]]) * 0.5**0.5)


KIND = Kind(
    place=1,
    group=Group.SEEN,
    aliases=("x",),
    edge_share=0.14,
    distance=prism(polygonal(corners_mm)),
    half_extent_mm=polygon_extent(corners_mm),
)
