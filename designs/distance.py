"""Pieces of signed distance functions: negative inside, in mm, exact near 0 unless noted.

Source: Quilez, Distance functions and 3D boolean operators.
"""

from __future__ import annotations

import numpy as np


def ellipse(points_mm: np.ndarray, half_x_mm: float, half_y_mm: float) -> np.ndarray:
    """Distance to an ellipse about the origin in X and Y, first order, shape (N,)."""
    x, y = points_mm[:, 0] / half_x_mm, points_mm[:, 1] / half_y_mm
    norm = np.sqrt(x * x + y * y)
    slope = np.hypot(x / half_x_mm, y / half_y_mm)
    # In the very middle both vanish: there half the narrower axis is as far as any.
    scale = np.where(slope > 1e-9, norm / np.maximum(slope, 1e-9), min(half_x_mm, half_y_mm))
    return scale * (norm - 1.0)


def rounded_both(first: np.ndarray, second: np.ndarray, radius_mm: float) -> np.ndarray:
    """What is inside both, with the edge between them rounded; exact between two planes at right
    angles: beyond both moved inward by r, the distance is that from where these meet, less r."""
    u, v = first + radius_mm, second + radius_mm
    return np.where((u > 0.0) & (v > 0.0), np.hypot(u, v) - radius_mm, np.maximum(first, second))


def cylinder(
    points_mm: np.ndarray,
    centre_mm: np.ndarray,
    axis: np.ndarray,
    radius_mm: float,
    span_mm: tuple[float, float],
) -> np.ndarray:
    """Distance to a cylinder between two places on its axis, measured from its centre."""
    x, y, z = (points_mm[:, k] - centre_mm[k] for k in range(3))
    along = x * axis[0] + y * axis[1] + z * axis[2]
    beside = np.sqrt(np.maximum(x * x + y * y + z * z - along * along, 0.0))
    ends = np.maximum(along - span_mm[1], span_mm[0] - along)
    return np.maximum(beside - radius_mm, ends)
