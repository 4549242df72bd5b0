"""The ball that fits a read dent best, by distance and not by squares of squares."""

from __future__ import annotations

import numpy as np

DEEP = 0.5
"""Share of the peak depth from which the skin follows the ball."""
FEWEST = 8
"""Vertices of a fit."""
LARGEST_MM = 200.0
"""Radius beyond which a dent counts as flat."""
ROBUST_MM = 0.02
"""Distance from which a vertex counts less."""


def ball_radius_mm(points_mm: np.ndarray, inward: np.ndarray, inward_mm: np.ndarray) -> float:
    """Radius of the ball; NaN where the dent is too small, or flat.

    Args:
        points_mm: Vertices at rest, shape (n, 3).
        inward: Their unit normals into the sensor, shape (n, 3).
        inward_mm: Their displacement along it, shape (n,).
    """
    from scipy.optimize import least_squares

    deep = inward_mm > DEEP * float(inward_mm.max(initial=0.0))
    if np.count_nonzero(deep) < FEWEST:
        return float("nan")
    places = points_mm[deep] + inward_mm[deep, None] * inward[deep]
    axis = inward[deep].mean(axis=0)
    axis /= np.linalg.norm(axis)
    deepest = places[np.argmax(inward_mm[deep])]

    def away(unknown: np.ndarray) -> np.ndarray:
        centre, radius = unknown[:3], np.exp(unknown[3])
        return np.linalg.norm(places - centre, axis=1) - radius

    def slopes(unknown: np.ndarray) -> np.ndarray:
        outward = places - unknown[:3]
        outward /= np.linalg.norm(outward, axis=1, keepdims=True)
        return np.column_stack([-outward, np.full(len(places), -np.exp(unknown[3]))])

    begin = np.append(deepest - 3.0 * axis, np.log(3.0))
    found = least_squares(away, begin, slopes, loss="soft_l1", f_scale=ROBUST_MM)  # pyright: ignore[reportArgumentType]
    radius_mm = float(np.exp(found.x[3]))
    outside = (found.x[:3] - deepest) @ axis < 0.0
    return radius_mm if found.success and outside and radius_mm < LARGEST_MM else float("nan")
