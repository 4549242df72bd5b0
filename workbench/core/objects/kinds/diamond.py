"""A regular octahedron, `size_mm` from tip to tip; presses with a tip.

Source: Quilez, Distance functions (octahedron).
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from workbench.core.objects.kind import Distance, Group, Kind


def distance(size_mm: float, edge_mm: float) -> Distance:
    """A face lies at half / sqrt(3) from the centre."""
    inner = 0.5 * size_mm - 3.0**0.5 * edge_mm
    return lambda place: to_octahedron(place, inner) - edge_mm


def to_octahedron(place: np.ndarray, half_mm: float) -> np.ndarray:
    """Distance to |x| + |y| + |z| <= half."""
    # With the axes in order of size, the face, an edge and a tip are met one after the other.
    ordered: Any = np.sort(np.abs(place), axis=1)
    small, middle, large = ordered.T
    over = small + middle + large - half_mm
    along = np.clip(0.5 * (large - middle + half_mm), 0.0, half_mm)
    edge = np.sqrt(small**2 + (middle - half_mm + along) ** 2 + (large - along) ** 2)
    return cast("np.ndarray", np.where(3.0 * small >= over, over / 3.0**0.5, edge))  # pyright: ignore[reportUnknownArgumentType]


def lowest_mm(size_mm: float, edge_mm: float) -> float:
    """The tip of the sharp body is cut back from sqrt(3) radii to one."""
    return 0.5 * size_mm - (3.0**0.5 - 1.0) * edge_mm


KIND = Kind(
    place=11,
    group=Group.UNSEEN,
    aliases=("octahedron",),
    edge_share=0.2,
    tip=True,
    distance=distance,
    lowest_mm=lowest_mm,
)
