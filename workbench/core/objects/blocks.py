"""Cylinders and the cube: as long as they are wide, their edges rounded."""

from __future__ import annotations

import numpy as np


def numbers(size_mm: float, edge_mm: float) -> np.ndarray:
    """Half width and half length of the shrunk body and the edge radius, shape (8,)."""
    half_mm = 0.5 * size_mm - edge_mm
    return np.array([half_mm, half_mm, edge_mm, 0.0, 0.0, 0.0, 0.0, 0.0])


def cylinder_corners(size_mm: float) -> list[tuple[float, float]]:
    """Section of the sharp cylinder."""
    half = 0.5 * size_mm
    return [(0.0, -half), (half, -half), (half, half), (0.0, half)]
