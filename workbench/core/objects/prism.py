"""Bodies that are a plane figure between two planes, as high as their size.

Outside both, the distance is that of a right angle. Left out: inside a re-entrant corner the depth
is that to the shrunk body, not to the corner.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.objects.kind import Distance
from workbench.core.objects.plane import Profile, inset, polygon


def prism(section: Callable[[float, float], Profile]) -> Callable[[float, float], Distance]:
    """Distance of a prism.

    Args:
        section: Of the size and the length by which it is shrunk [mm], the figure's distance.
    """

    def of(size_mm: float, edge_mm: float) -> Distance:
        figure, half_mm = section(size_mm, edge_mm), 0.5 * size_mm - edge_mm
        return lambda place: extruded(place, figure, half_mm) - edge_mm

    return of


def extruded(place: np.ndarray, section: Profile, half_mm: float) -> np.ndarray:
    """Distance to a figure between the planes at `half_mm`, shape (N,)."""
    over = np.stack([section(place[:, :2]), np.abs(place[:, 2]) - half_mm])
    return np.minimum(over.max(axis=0), 0.0) + np.hypot(*np.maximum(over, 0.0))


def polygonal(corners: Callable[[float], np.ndarray]) -> Callable[[float, float], Profile]:
    """Section of a polygon whose corners (C, 2), counter-clockwise, follow from the size."""

    def of(size_mm: float, shrink_mm: float) -> Profile:
        shrunk = inset(corners(size_mm), shrink_mm)
        return lambda place: polygon(place, shrunk)

    return of


def polygon_extent(corners: Callable[[float], np.ndarray]) -> Callable[[float], np.ndarray]:
    """Half widths of such a prism: a triangle reaches beyond half its side on one side only."""
    return lambda size_mm: np.append(np.abs(corners(size_mm)).max(axis=0), 0.5 * size_mm)
