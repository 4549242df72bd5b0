"""Heads of the paper's indenters as they were released: what all fourteen have in common.

A head stands on a block of 16 x 16 mm, which is left out here, and is 10 mm long; at another size
all of it is larger or smaller. Body +X is the released file's +y, +Y its +z, +Z its +x.
The files have sharp edges; they are rounded like those of every other object.
Source: the indenters' files of the release of SimTac.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.objects.kind import Distance, Group, Kind
from workbench.core.objects.prism import Section, polygonal, prism

LENGTH_MM = 10.0
FIRST_PLACE = 100
"""Where the first of them stands in lists."""


def head(
    number: int,
    *,
    size_mm: float,
    wide_mm: tuple[float, float],
    distance: Callable[[float, float], Distance],
    edge_share: float = 0.2,
) -> Kind:
    """The record of a head.

    Args:
        number: Its place among the fourteen.
        size_mm: Its largest width along X or Y.
        wide_mm: How far it reaches from its axis at most, along X and along Y.
        distance: Its signed distance.
        edge_share: Largest edge radius over the size.
    """
    half = np.array([*wide_mm, 0.5 * LENGTH_MM]) / size_mm
    return Kind(
        place=FIRST_PLACE + number,
        group=Group.RELEASED,
        own_mm=size_mm,
        edge_share=edge_share,
        distance=distance,
        half_extent_mm=lambda size_mm: size_mm * half,
        lowest_mm=lambda size_mm, edge_mm: size_mm * float(half[2]),
    )


def standing(section: Section, size_mm: float) -> Callable[[float, float], Distance]:
    """Distance of a head of one section all along, whose own size is `size_mm`."""
    return prism(section, length=LENGTH_MM / size_mm)


def cornered(
    corners_mm: list[tuple[float, float]], size_mm: float
) -> Callable[[float, float], Distance]:
    """Distance of a head whose section is a polygon, corners counter-clockwise, in its own size."""
    shares = np.array(corners_mm) / size_mm
    return standing(polygonal(lambda size_mm: size_mm * shares), size_mm)
