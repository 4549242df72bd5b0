"""Less noise in light by direction: the mean of each node's bins and its neighbours'.

A neighbour's azimuths are turned into the node's frame, by the angle of its t there and between two
bins in proportion; cosines to the normal are kept, as light that follows the skin keeps them. One
pass takes the noise of seven nodes together and blurs by one spacing, which the table's linear
interpolation does anyway.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core.result.light import AZIMUTHS


def smoothed_bins(bins: np.ndarray, frames: np.ndarray, links: Any) -> np.ndarray:
    """Light by direction after one pass, shape (N, 3, B), float32.

    Args:
        bins: Before, shape (N, 3, B).
        frames: Rows t, b, n of the nodes, shape (N, 3, 3).
        links: Sparse (N, N) matrix of weights, each row summing to 1.
    """
    count = len(bins)
    rows = bins.reshape(count, -1, AZIMUTHS)
    total = np.zeros_like(rows, dtype=np.float32)
    links = links.tocsr()
    degrees = np.diff(links.indptr)
    for slot in range(int(degrees.max())):
        has = np.flatnonzero(degrees > slot)
        entry = links.indptr[has] + slot
        other = links.indices[entry]
        turned = _turned(rows[other], _angles(frames[has], frames[other]))
        total[has] += links.data[entry].astype(np.float32)[:, None, None] * turned
    return total.reshape(bins.shape)


def _angles(here: np.ndarray, there: np.ndarray) -> np.ndarray:
    """Azimuth of the others' t in the frames here, in bins, shape (M,)."""
    along = np.einsum("mi,mi->m", there[:, 0], here[:, 0])
    across = np.einsum("mi,mi->m", there[:, 0], here[:, 1])
    return np.arctan2(across, along) / (2.0 * np.pi) * AZIMUTHS


def _turned(rows: np.ndarray, bins: np.ndarray) -> np.ndarray:
    """Rows (M, K, AZIMUTHS) moved on by a number of bins (M,), shared between the two nearest."""
    whole = np.floor(bins).astype(int)
    share = (bins - whole).astype(np.float32)[:, None, None]
    source = (np.arange(AZIMUTHS) - whole[:, None]) % AZIMUTHS
    source = np.broadcast_to(source[:, None, :], rows.shape)
    moved = np.take_along_axis(rows, source, axis=2)
    return (1.0 - share) * moved + share * np.roll(moved, 1, axis=2)
