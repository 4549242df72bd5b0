"""Exact signed distances of plane figures, in plain NumPy: the cross-sections of prisms.

A figure is first shrunk by the edge radius (straight sides move inward, corners stay sharp), so
that its distance less the radius is the figure with its convex corners rounded. Distances are
the least over the straight and round pieces of the outline, with the sign of an inside test.
Source of the polygon distance: Quilez, 2D distance functions.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

Profile = Callable[[np.ndarray], np.ndarray]
"""Signed distances [mm], shape (N,), of places (N, 2)."""
ARC_POINTS = 33
"""Points that bracket the foot on a quarter of an ellipse."""
HALVINGS = 40


def polygon(place: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Signed distance of a simple polygon, corners (C, 2), at places (N, 2)."""
    distance = np.full(len(place), np.inf)
    inside = np.zeros(len(place), dtype=bool)
    for start, stop in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        distance = np.minimum(distance, segment(place, start, stop))
        above = place[:, 1] >= start[1], place[:, 1] >= stop[1]
        left = turn(stop - start, place - start) > 0.0
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


def ellipse_arc(place: np.ndarray, semi_axes: tuple[float, float]) -> np.ndarray:
    """Distance of places (N, 2) to the quarter of an ellipse from its tip on +X to that on +Y.

    Of places below the X axis too, whose nearest may be the tip. The nearest of a few points
    brackets the foot, the sign of the slope of the distance along the arc halves the bracket.
    """
    a, b = semi_axes
    angle: np.ndarray = np.linspace(0.0, 0.5 * np.pi, ARC_POINTS)
    far = (place[:, :1] - a * np.cos(angle)) ** 2 + (place[:, 1:] - b * np.sin(angle)) ** 2
    middle: np.ndarray = angle[np.argmin(far, axis=1)]
    low: np.ndarray = np.maximum(middle - angle[1], 0.0)
    high: np.ndarray = np.minimum(middle + angle[1], angle[-1])
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        x, y = a * np.cos(middle), b * np.sin(middle)
        # The product of the way to the place and the arc's tangent (-y a / b, x b / a).
        nearer = (place[:, 1] - y) * x * b / a > (place[:, 0] - x) * y * a / b
        low = np.asarray(np.where(nearer, middle, low))
        high = np.asarray(np.where(nearer, high, middle))
    return np.hypot(place[:, 0] - a * np.cos(middle), place[:, 1] - b * np.sin(middle))


def bitten(radius_mm: float, half_angle: float, shrink_mm: float) -> Profile:
    """A disc with a mouth toward +X that opens by `half_angle` [rad] to each side, shrunk."""
    radius = radius_mm - shrink_mm
    apex = np.array([-shrink_mm / np.sin(half_angle), 0.0])
    lip = np.array([np.cos(half_angle), np.sin(half_angle)])
    along = -apex @ lip + np.sqrt((apex @ lip) ** 2 + radius**2 - apex @ apex)
    corner = apex + along * lip
    half = np.pi - float(np.arctan2(corner[1], corner[0]))

    def distance(place: np.ndarray) -> np.ndarray:
        upper = np.stack([place[:, 0], np.abs(place[:, 1])], axis=1)
        jaw = segment(upper, apex, corner)
        unsigned = np.minimum(jaw, arc(upper, np.zeros(2), radius, np.pi, half))
        in_mouth = turn(lip, upper - apex) < 0.0
        inside = (np.linalg.norm(place, axis=1) < radius) & ~in_mouth
        return np.where(inside, -unsigned, unsigned)

    return distance


def meet(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Distance to what is in both of two bodies whose faces stand at right angles, shape (N,)."""
    over = np.stack([first, second])
    return np.minimum(over.max(axis=0), 0.0) + np.hypot(*np.maximum(over, 0.0))


def inset(corners: np.ndarray, by_mm: float) -> np.ndarray:
    """A counter-clockwise polygon (C, 2) with every side moved inward."""
    edge = np.roll(corners, -1, axis=0) - corners
    edge /= np.linalg.norm(edge, axis=1, keepdims=True)
    inward = np.stack([-edge[:, 1], edge[:, 0]], axis=1)
    both = inward + np.roll(inward, 1, axis=0)
    reach = 2.0 / np.einsum("ij,ij->i", both, both)
    return corners + by_mm * both * reach[:, None]


def turn(edge: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """Cross product of a vector (2,) with vectors (N, 2): positive on its left."""
    return edge[0] * offset[:, 1] - edge[1] * offset[:, 0]


def regular(count: int, radius_mm: float, first: float) -> np.ndarray:
    """Corners of a regular polygon, shape (C, 2), the first at the angle `first` [rad]."""
    angle = first + 2.0 * np.pi * np.arange(count) / count
    return radius_mm * np.stack([np.cos(angle), np.sin(angle)], axis=1)
