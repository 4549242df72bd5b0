"""The fixed order of triangles, and the levels of the tree over those that moved."""

from __future__ import annotations

import numpy as np

from sim.optics.raster.tree_kernels import LEAF, LEVELS, WIDTH

CURVE_BITS = 10
"""Bits per axis of the space-filling curve: cells of a thousandth of the skin."""


def order_of_faces(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Numbers of the faces along Morton's curve through their centres, shape (F,), int32."""
    centre = points_mm[faces].mean(axis=1)
    low = centre.min(axis=0)
    size = max(float(np.ptp(centre, axis=0).max()), 1e-9)
    cell = np.minimum((centre - low) / size * 2**CURVE_BITS, 2**CURVE_BITS - 1).astype(np.int64)
    code = np.zeros(len(faces), dtype=np.int64)
    for bit in range(CURVE_BITS):
        for axis in range(3):
            code |= ((cell[:, axis] >> bit) & 1) << (3 * bit + axis)
    return np.argsort(code, kind="stable").astype(np.int32)


def tree_levels(triangles: int) -> tuple[int, np.ndarray]:
    """Levels of a tree over so many triangles, and where each begins among the boxes.

    Levels that it lacks begin where the boxes end: shape (LEVELS + 1,), int32.
    """
    counts = [max(1, -(-triangles // LEAF))]
    while counts[-1] > WIDTH:
        counts.append(-(-counts[-1] // WIDTH))
    start = np.full(LEVELS + 1, sum(counts), dtype=np.int32)
    start[: len(counts)] = np.cumsum([0, *counts[:-1]])
    return len(counts), start
