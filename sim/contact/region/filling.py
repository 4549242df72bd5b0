"""Material points of a body that is known by its signed distance.

Fractions come from 4x4x4 samples of each sub-cell that the surface may cut.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.result.results import MaterialPoints

SAMPLES = 4
"""Samples per axis of a sub-cell."""


Distance = Callable[[np.ndarray], np.ndarray]


def fill(distance: Distance, low: np.ndarray, high: np.ndarray, grid_mm: float) -> MaterialPoints:
    """Material points of the solid where a distance-like function is negative.

    Args:
        distance: Positions (..., 3) to values; its slope is at most 1.
        low: Lower corner of the solid's box [mm], shape (3,).
        high: Upper corner.
        grid_mm: Cell edge.
    """
    first = np.floor(low / grid_mm).astype(int) - 1
    last = np.ceil(high / grid_mm).astype(int) + 1
    axes = [np.arange(a, b + 1) for a, b in zip(first, last, strict=True)]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = cells[distance(cells * grid_mm) < 0.87 * grid_mm]
    bits = np.stack(np.meshgrid(*[[-0.25, 0.25]] * 3, indexing="ij"), axis=-1).reshape(8, 3)
    centres = (cells[:, None] + bits) * grid_mm
    value = distance(centres)
    fractions = (value < 0).astype(np.float32)
    cut = np.abs(value) < 0.45 * grid_mm
    step = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
    offsets = np.stack(np.meshgrid(*[step] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    samples = centres[cut][:, None] + 0.5 * grid_mm * offsets
    fractions[cut] = (distance(samples) < 0).mean(axis=1)
    held = fractions.any(axis=1)
    return MaterialPoints(
        grid_mm=grid_mm, cells=cells[held].astype(np.int32), fractions=fractions[held]
    )
