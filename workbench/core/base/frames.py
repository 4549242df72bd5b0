"""Orientations: the tangent frame of a press, and a rotation as a quaternion."""

from __future__ import annotations

import numpy as np

PARALLEL = 1e-3
"""Sine of the angle between normal and Z below which U follows X instead."""


def tangent(normal: np.ndarray) -> np.ndarray:
    """Unit U of the tangent plane, shape (3,).

    U is +Z projected, or +X projected where the normal is parallel to Z; V = normal x U.

    Args:
        normal: Outward unit normal, shape (3,).

    Raises:
        ValueError: If the normal is not a number.
    """
    for axis in (np.array([0.0, 0.0, 1.0]), np.array([1.0, 0.0, 0.0])):
        projected = axis - (axis @ normal) * normal
        length = np.linalg.norm(projected)
        if length > PARALLEL:
            return projected / length
    raise ValueError(f"normal {normal} is not a unit vector")


def quaternion(rotation: np.ndarray) -> np.ndarray:
    """Unit quaternion w, x, y, z with w >= 0 of a rotation matrix, shape (4,).

    The eigenvector of the largest eigenvalue of Bar-Itzhack's matrix (J. Guidance 23, 2000).
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation
    matrix = np.array(
        [
            [xx + yy + zz, zy - yz, xz - zx, yx - xy],
            [zy - yz, xx - yy - zz, xy + yx, xz + zx],
            [xz - zx, xy + yx, yy - xx - zz, yz + zy],
            [yx - xy, xz + zx, yz + zy, zz - xx - yy],
        ]
    )
    result = np.linalg.eigh(matrix)[1][:, -1]
    return result if result[0] >= 0 else -result
