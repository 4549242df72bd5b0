"""Pieces of signed distance functions: negative inside, in mm, exact near 0 unless noted.

Source: Quilez, Distance functions and 3D boolean operators.
"""

from __future__ import annotations

import numpy as np


def ellipse(points_mm: np.ndarray, half_x_mm: float, half_y_mm: float) -> np.ndarray:
    """Distance to an ellipse about the origin in X and Y, first order, shape (N,)."""
    axes = np.array([half_x_mm, half_y_mm])
    norm = np.sqrt(((points_mm[:, :2] / axes) ** 2).sum(axis=1))
    slope = np.sqrt(((points_mm[:, :2] / axes**2) ** 2).sum(axis=1))
    return norm * (norm - 1.0) / np.maximum(slope, 1e-9)


def rounded_both(
    first: np.ndarray, second: np.ndarray, radius_mm: float, cosine: np.ndarray | float = 0.0
) -> np.ndarray:
    """What is inside both, with the edge between them rounded; exact between two planes.

    With u and v the distances from the planes moved inward by r, and c the cosine between their
    normals, a point beyond both feet has the distance sqrt((u^2 + v^2 - 2 c u v) / (1 - c^2)) - r.
    """
    u, v = first + radius_mm, second + radius_mm
    beyond = (u > cosine * v) & (v > cosine * u) & ((u > 0.0) | (v > 0.0))
    square = (u**2 + v**2 - 2.0 * cosine * u * v) / np.maximum(1.0 - np.square(cosine), 1e-6)
    return np.where(beyond, np.sqrt(np.maximum(square, 0.0)) - radius_mm, np.maximum(first, second))


def cylinder(
    points_mm: np.ndarray,
    centre_mm: np.ndarray,
    axis: np.ndarray,
    radius_mm: float,
    span_mm: tuple[float, float],
) -> np.ndarray:
    """Distance to a cylinder between two places on its axis, measured from its centre."""
    offset = points_mm - centre_mm
    along = offset @ axis
    beside = np.sqrt(np.maximum((offset**2).sum(axis=1) - along**2, 0.0))
    return np.maximum.reduce([beside - radius_mm, along - span_mm[1], span_mm[0] - along])
