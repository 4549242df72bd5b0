"""Bodies that are a plane figure between two planes, as high as their size where not said.

Outside both, the distance is that of a right angle. Left out: inside a re-entrant corner the depth
is that to the shrunk body, not to the corner.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.objects.kind import Distance
from workbench.core.objects.plane import Profile, inset, meet, polygon

Section = Callable[[float, float], Profile]
"""Of the size and the length by which it is shrunk [mm], a figure's distance."""


def prism(section: Section, *, length: float = 1.0) -> Callable[[float, float], Distance]:
    """Distance of a prism.

    Args:
        section: The figure across Z.
        length: From end to end, over the size.
    """

    def of(size_mm: float, edge_mm: float) -> Distance:
        figure, half_mm = section(size_mm, edge_mm), 0.5 * length * size_mm - edge_mm
        return lambda place: extruded(place, figure, half_mm) - edge_mm

    return of


def lying(section: Section, *, length: float) -> Callable[[float, float], Distance]:
    """Distance of a prism along X, whose section lies across it: places (y, z)."""

    def of(size_mm: float, edge_mm: float) -> Distance:
        along = prism(section, length=length)(size_mm, edge_mm)
        return lambda place: along(place[:, [1, 2, 0]])

    return of


def extruded(place: np.ndarray, section: Profile, half_mm: float) -> np.ndarray:
    """Distance to a figure between the planes at `half_mm`, shape (N,)."""
    return meet(section(place[:, :2]), np.abs(place[:, 2]) - half_mm)


def polygonal(corners: Callable[[float], np.ndarray]) -> Section:
    """Section of a polygon whose corners (C, 2), counter-clockwise, follow from the size."""

    def of(size_mm: float, shrink_mm: float) -> Profile:
        shrunk = inset(corners(size_mm), shrink_mm)
        return lambda place: polygon(place, shrunk)

    return of


def polygon_extent(corners: Callable[[float], np.ndarray]) -> Callable[[float], np.ndarray]:
    """Half widths of such a prism: a triangle reaches beyond half its side on one side only."""
    return lambda size_mm: np.append(np.abs(corners(size_mm)).max(axis=0), 0.5 * size_mm)
