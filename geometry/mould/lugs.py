"""Lugs: what holds the core in its place to the outer parts without being in the way of any.

A rim around the block would be in the way of every outer part. A lug stands on the flange astride a
seam, half of its socket in each of the two parts that meet there: bolted together they hold it
between them, and each leaves it along its own pull. Two parts leave a lug straight away from each
other, so theirs is a box; three or four leave it at up to 45 degrees to the seam, so theirs is a
rhomb whose sides slope by more.
"""

from __future__ import annotations

import numpy as np

from geometry.body import csg
from geometry.mould.mould_layout import Layout

HALF_WIDTH_MM = 2.5
"""Across the seam, of a box [mm]."""
HALF_LENGTH_MM = 2.0
"""Along the seam, of a box [mm]."""
RHOMB_MM = (1.9, 1.4)
"""Half diagonals along and across the seam [mm]: sides at 54 degrees to it from its normal."""
LEAST_MM = 0.5
"""Blocks too low for lugs of this height have none [mm]."""
ROOT_MM = 1.0
"""How deep a lug is rooted in the flange [mm]."""
SLOPE_PLACES = 9


def lugs(
    places: tuple[tuple[np.ndarray, np.ndarray], ...], layout: Layout, gap_mm: float | None
) -> list[csg.Node]:
    """Lugs of the flange, or with a gap their sockets in the outer parts.

    Args:
        places: x and y [mm], and direction along the seam, shape (2,) each.
        gap_mm: Between lug and socket.
    """
    if layout.lug_mm < LEAST_MM:
        return []
    gap = gap_mm or 0.0
    # Sockets begin below the block, so that no face of theirs lies in its bottom.
    low, high = layout.base_mm - ROOT_MM, layout.base_mm + layout.lug_mm + gap
    if layout.round:
        return [_rhomb(place, along, (low, high), gap) for place, along in places]
    return [_box(place, layout, (low, high), gap) for place, _ in places]


def _box(
    place: np.ndarray, layout: Layout, span_mm: tuple[float, float], gap_mm: float
) -> csg.Node:
    """As wide as the seam wanders over its height, so that neither part reaches around it."""
    heights = np.linspace(layout.base_mm, layout.base_mm + layout.lug_mm, SLOPE_PLACES)
    seam = layout.parting.curve_x_mm(heights)
    wide, long = HALF_WIDTH_MM + gap_mm, HALF_LENGTH_MM + gap_mm
    return csg.Box(
        low_mm=(float(seam.min()) - wide, float(place[1]) - long, span_mm[0]),
        high_mm=(float(seam.max()) + wide, float(place[1]) + long, span_mm[1]),
    )


def _rhomb(
    place: np.ndarray, along: np.ndarray, span_mm: tuple[float, float], gap_mm: float
) -> csg.Node:
    across = np.array([-along[1], along[0]])
    half = np.array(RHOMB_MM)
    # Sides move out by the gap when the diagonals grow by it over the sine of their slope.
    long, wide = half + gap_mm * np.linalg.norm(half) / half[::-1]
    corners = place + np.array([long * along, wide * across, -long * along, -wide * across])
    return csg.Prism(polygon_mm=corners, low_mm=span_mm[0], high_mm=span_mm[1])
