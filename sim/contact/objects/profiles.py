"""Exact signed distances of plane figures, in plain NumPy: the cross-sections of extruded objects.

A figure is first shrunk by the edge radius (straight sides move inward, corners stay sharp), so
that its distance less the radius is the figure with its convex corners rounded. Distances are
the least over the straight and round pieces of the outline, with the sign of an inside test.
Source of the polygon distance: Quilez, 2D distance functions. Widths are those of `IndenterKind`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.indenter import IndenterKind

Profile = Callable[[np.ndarray], np.ndarray]
"""Signed distances [mm], shape (N,), of places (N, 2)."""

CROSS_BAR = 0.3
RHOMBUS_HEIGHT = 0.6
RING_WALL = 0.25
PIN_WIDTH = 0.45
MOUTH_HALF_ANGLE = np.pi / 6
PETALS = 5
PETAL_RADIUS = 0.19
"""Radius of a petal over the size; neighbours overlap, as 0.19 > 0.31 sin(36 degrees)."""


def profile(kind: IndenterKind, size_mm: float, shrink_mm: float) -> Profile:
    """Distance of a kind's cross-section, shrunk by `shrink_mm`."""
    if kind in POLYGONS:
        corners = inset(POLYGONS[kind](size_mm), shrink_mm)
        return lambda place: polygon(place, corners)
    return {
        IndenterKind.PACMAN: _pacman,
        IndenterKind.DOUBLE_CYLINDER: _pins,
        IndenterKind.FLOWER: _flower,
        IndenterKind.RING: _ring,
    }[kind](size_mm, shrink_mm)


def polygon(place: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Signed distance of a simple polygon, corners (C, 2), at places (N, 2)."""
    distance = np.full(len(place), np.inf)
    inside = np.zeros(len(place), dtype=bool)
    for start, stop in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        distance = np.minimum(distance, segment(place, start, stop))
        above = place[:, 1] >= start[1], place[:, 1] >= stop[1]
        left = _turn(stop - start, place - start) > 0.0
        inside ^= (above[0] != above[1]) & (left == (stop[1] > start[1]))
    return np.where(inside, -distance, distance)


def segment(place: np.ndarray, start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """Distance of places (N, 2) to a straight piece."""
    edge = stop - start
    along = np.clip((place - start) @ edge / (edge @ edge), 0.0, 1.0)
    return np.linalg.norm(place - start - along[:, None] * edge, axis=1)


def arc(
    place: np.ndarray, centre: np.ndarray, radius: float, middle: float, half: float
) -> np.ndarray:
    """Distance of places (N, 2) to an arc about `middle` that spans `half` [rad] to each side."""
    offset = place - centre
    across = np.array([np.cos(middle), np.sin(middle)])
    # Mirrored about the middle of the arc, only its one end can be nearest.
    x = offset @ across
    y = np.abs(offset @ np.array([-across[1], across[0]]))
    end = np.hypot(x - radius * np.cos(half), y - radius * np.sin(half))
    return np.where(np.arctan2(y, x) <= half, np.abs(np.hypot(x, y) - radius), end)


def inset(corners: np.ndarray, by_mm: float) -> np.ndarray:
    """A counter-clockwise polygon (C, 2) with every side moved inward."""
    edge = np.roll(corners, -1, axis=0) - corners
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    inward = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
    both = inward + np.roll(inward, 1, axis=0)
    reach = 2.0 / np.einsum("ij,ij->i", both, both)
    return corners + by_mm * both * reach[:, None]


def _turn(edge: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Cross product of a vector (2,) with vectors (N, 2): positive on its left."""
    return edge[0] * offset[:, 1] - edge[1] * offset[:, 0]


def _regular(count: int, radius_mm: float, first: float) -> np.ndarray:
    angle = first + 2.0 * np.pi * np.arange(count) / count
    return radius_mm * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _cross_corners(size_mm: float) -> np.ndarray:
    long, wide = 0.5 * size_mm, 0.5 * CROSS_BAR * size_mm
    quarter = np.array([[long, -wide], [long, wide], [wide, wide]])
    turns = [np.array([[c, -s], [s, c]]) for c, s in ((1, 0), (0, 1), (-1, 0), (0, -1))]
    upright = np.concatenate([quarter @ turn.T for turn in turns])
    return upright @ (np.array([[1.0, 1.0], [-1.0, 1.0]]) * 0.5**0.5)


POLYGONS: dict[IndenterKind, Callable[[float], np.ndarray]] = {
    IndenterKind.CROSS: _cross_corners,
    IndenterKind.TRIANGLE: lambda size_mm: _regular(3, size_mm / 3**0.5, np.pi / 2),
    IndenterKind.HEXAGON: lambda size_mm: _regular(6, size_mm / 2, 0.0),
    IndenterKind.RHOMBUS: lambda size_mm: _regular(4, size_mm / 2, 0.0) * [1.0, RHOMBUS_HEIGHT],
}


def _pacman(size_mm: float, shrink_mm: float) -> Profile:
    radius = 0.5 * size_mm - shrink_mm
    apex = np.array([-shrink_mm / np.sin(MOUTH_HALF_ANGLE), 0.0])
    lip = np.array([np.cos(MOUTH_HALF_ANGLE), np.sin(MOUTH_HALF_ANGLE)])
    along = -apex @ lip + np.sqrt((apex @ lip) ** 2 + radius**2 - apex @ apex)
    corner = apex + along * lip
    half = np.pi - np.arctan2(corner[1], corner[0])

    def distance(place: np.ndarray) -> np.ndarray:
        upper = np.stack([place[:, 0], np.abs(place[:, 1])], axis=1)
        jaw = segment(upper, apex, corner)
        unsigned = np.minimum(jaw, arc(upper, np.zeros(2), radius, np.pi, half))
        in_mouth = _turn(lip, upper - apex) < 0.0
        inside = (np.linalg.norm(place, axis=1) < radius) & ~in_mouth
        return np.where(inside, -unsigned, unsigned)

    return distance


def _pins(size_mm: float, shrink_mm: float) -> Profile:
    radius = 0.5 * PIN_WIDTH * size_mm
    centre = 0.5 * size_mm - radius
    return lambda place: np.hypot(np.abs(place[:, 0]) - centre, place[:, 1]) - (radius - shrink_mm)


def _ring(size_mm: float, shrink_mm: float) -> Profile:
    wall = RING_WALL * size_mm
    middle = 0.5 * (size_mm - wall)
    return lambda place: np.abs(np.hypot(*place.T) - middle) - (0.5 * wall - shrink_mm)


def _flower(size_mm: float, shrink_mm: float) -> Profile:
    """The petals' outer arcs. It has no convex corner, so shrinking only adds to the distance."""
    radius, sector = PETAL_RADIUS * size_mm, np.pi / PETALS
    centre = np.array([0.5 * size_mm - radius, 0.0])
    notch_mm = float(
        centre[0] * np.cos(sector) + np.sqrt(radius**2 - (centre[0] * np.sin(sector)) ** 2)
    )
    notch = notch_mm * np.array([np.cos(sector), np.sin(sector)])
    half = float(np.arctan2(notch[1], notch[0] - centre[0]))

    def distance(place: np.ndarray) -> np.ndarray:
        rho = np.hypot(*place.T)
        # Turned into the sector of the petal toward +X, whose arc is then the nearest.
        angle = np.arctan2(place[:, 1], place[:, 0])
        angle -= 2.0 * sector * np.round(angle / (2.0 * sector))
        turned = rho[:, None] * np.stack([np.cos(angle), np.abs(np.sin(angle))], axis=1)
        unsigned = arc(turned, centre, radius, 0.0, half)
        in_petal = np.linalg.norm(turned - centre, axis=1) < radius
        inside = in_petal | (turned[:, 0] < notch[0])
        return np.where(inside, -unsigned, unsigned) + shrink_mm

    return distance


def area_mm2(kind: IndenterKind, size_mm: float) -> float:
    """Area of a kind's sharp cross-section [mm2]: the closed form that volumes are checked by."""
    if kind in POLYGONS:
        x, y = POLYGONS[kind](size_mm).T
        return 0.5 * float(x @ np.roll(y, -1) - y @ np.roll(x, -1))
    radius = 0.5 * size_mm
    if kind is IndenterKind.PACMAN:
        return (np.pi - MOUTH_HALF_ANGLE) * radius**2
    if kind is IndenterKind.DOUBLE_CYLINDER:
        return 2.0 * np.pi * (PIN_WIDTH * radius) ** 2
    if kind is IndenterKind.RING:
        return np.pi * (radius**2 - (radius - RING_WALL * size_mm) ** 2)
    return _flower_area_mm2(size_mm)


def _flower_area_mm2(size_mm: float) -> float:
    """Per petal a kite from the middle to two notches and the sector of the arc."""
    radius, sector = PETAL_RADIUS * size_mm, np.pi / PETALS
    centre = 0.5 * size_mm - radius
    notch = centre * np.cos(sector) + np.sqrt(radius**2 - (centre * np.sin(sector)) ** 2)
    half = np.arctan2(notch * np.sin(sector), notch * np.cos(sector) - centre)
    return float(PETALS * (centre * notch * np.sin(sector) + half * radius**2))
