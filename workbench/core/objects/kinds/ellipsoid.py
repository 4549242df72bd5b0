"""Axes of 1, 0.7 and 0.5 `size_mm` along X, Y and Z.

Source: Eberly, Distance from a point to an ellipsoid.
"""

from __future__ import annotations

from typing import Any, cast

import numpy as np

from workbench.core.objects.kind import Distance, Group, Kind

AXES = np.array([1.0, 0.7, 0.5])
BISECTIONS = 60
LEAST_SHARE = 1e-9
"""Places are kept this share of an axis off the ellipsoid's planes, where the root is double."""


def distance(size_mm: float, edge_mm: float) -> Distance:
    """It has no edges to round."""
    semi_axes = 0.5 * size_mm * AXES
    return lambda place: to_ellipsoid(place, semi_axes)


def to_ellipsoid(place: np.ndarray, semi_axes: np.ndarray) -> np.ndarray:
    """The foot e^2 y / (t + e^2) of a place y, with t the largest root of |e y / (t + e^2)| = 1."""
    where = np.maximum(np.abs(place), LEAST_SHARE * semi_axes)
    least = int(np.argmin(semi_axes))
    low: np.ndarray = semi_axes[least] * where[:, least] - semi_axes[least] ** 2
    high: np.ndarray = np.linalg.norm(semi_axes * where, axis=1) - semi_axes[least] ** 2
    for _ in range(BISECTIONS):
        middle = 0.5 * (low + high)
        ratio = semi_axes * where / (middle[:, None] + semi_axes**2)
        beyond = np.einsum("nc,nc->n", ratio, ratio) > 1.0
        low = np.asarray(np.where(beyond, middle, low))
        high = np.asarray(np.where(beyond, high, middle))
    foot = semi_axes**2 * where / (0.5 * (low + high)[:, None] + semi_axes**2)
    distance: Any = np.linalg.norm(where - foot, axis=1)
    inside: Any = np.linalg.norm(where / semi_axes, axis=1) < 1.0
    return cast("np.ndarray", np.where(inside, -distance, distance))  # pyright: ignore[reportUnknownArgumentType]


KIND = Kind(
    place=5,
    group=Group.SEEN,
    edge_share=None,
    distance=distance,
    half_extent_mm=lambda size_mm: 0.5 * size_mm * AXES,
    lowest_mm=lambda size_mm, edge_mm: 0.5 * size_mm * float(AXES[2]),
    sharpest_mm=lambda size_mm, edge_mm: 0.5 * size_mm * float(AXES[2] ** 2 / AXES[0]),
)
