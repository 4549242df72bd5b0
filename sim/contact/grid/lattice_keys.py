"""Lattice points as whole numbers that sort by x, y, z: 21 signed bits for each of the three."""

from __future__ import annotations

import numpy as np

_SPAN = 1 << 21
_HALF = _SPAN >> 1


def keys_of(lattice: np.ndarray) -> np.ndarray:
    """Keys of lattice points, shape (..., 3), within 2**20 cells of the origin; shape (...)."""
    x, y, z = np.moveaxis(lattice.astype(np.int64) + _HALF, -1, 0)
    return (x * _SPAN + y) * _SPAN + z


def cells_of(keys: np.ndarray) -> np.ndarray:
    """Lattice points of keys, shape (..., 3)."""
    return np.stack([keys // _SPAN**2, keys // _SPAN % _SPAN, keys % _SPAN], axis=-1) - _HALF


def look_up(sorted_keys: np.ndarray, keys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place of each key among sorted keys, and whether it is there."""
    place = np.minimum(np.searchsorted(sorted_keys, keys), len(sorted_keys) - 1)
    return place, sorted_keys[place] == keys
