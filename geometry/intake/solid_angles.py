"""The generalised winding number of triangles at single places, as near to a face as one likes.

The sum of the solid angles under which a place sees the triangles, over 4 pi (van Oosterom and
Strackee, The solid angle of a plane triangle, 1983). Triangles far away act as one dipole per
cluster (Barill and others, Fast winding numbers for soups and clouds, 2018). The grid of
`geometry.intake.winding` knows it everywhere at once, but not within a step of a face.
"""

from __future__ import annotations

import numpy as np

CELLS = 24
"""Clusters along the longest side."""
FAR = 2.5
"""Distance over radius from which a cluster is one dipole: it errs by a hundredth."""
MOST_PAIRS = 400_000
"""Places times triangles, or clusters, at once."""


class WindingNumber:
    """That of triangles, ready to be asked for."""

    def __init__(self, points: np.ndarray, faces: np.ndarray) -> None:
        """Gather the triangles in clusters.

        Args:
            points: Vertices (V, 3).
            faces: Triangles (M, 3), counter-clockwise from outside.
        """
        corners = points[faces]
        number = _cluster_of_each(corners)
        order = np.argsort(number, kind="stable")
        self._corners, number = corners[order], number[order]
        self._size = np.bincount(number)
        self._first = np.cumsum(self._size) - self._size
        a, b, c = (self._corners[:, k] for k in range(3))
        area = 0.5 * np.cross(b - a, c - a)
        weight = np.linalg.norm(area, axis=1)[:, None] + 1e-300
        self._area = np.add.reduceat(area, self._first)
        self._centre = np.add.reduceat(weight * (a + b + c) / 3.0, self._first)
        self._centre /= np.add.reduceat(weight, self._first)
        away = np.linalg.norm(self._corners - self._centre[number][:, None], axis=2)
        self._radius = np.maximum.reduceat(away.max(axis=1), self._first)

    def at(self, places: np.ndarray) -> np.ndarray:
        """About 1 inside and 0 outside, shape (N,), at places (N, 3) that are on no triangle."""
        found = np.zeros(len(places))
        rows = max(1, MOST_PAIRS // len(self._size))
        for start in range(0, len(places), rows):
            some = places[start : start + rows]
            away = self._centre[None] - some[:, None]
            square = np.einsum("qcj,qcj->qc", away, away)
            near = square <= (FAR * self._radius) ** 2
            along = np.einsum("qcj,cj->qc", away, self._area)
            dipole = along / np.where(near, np.inf, square) ** 1.5
            query, cluster = np.nonzero(near)
            angle = _of_runs(some, self._corners, query, self._first[cluster], self._size[cluster])
            found[start : start + rows] = (dipole.sum(axis=1) + angle) / (4.0 * np.pi)
        return found


def _cluster_of_each(corners: np.ndarray) -> np.ndarray:
    """Triangles of a cell and of like size are one cluster, numbers of shape (M,)."""
    cell = float(np.ptp(corners.reshape(-1, 3), axis=0).max()) / CELLS
    where = ((corners.mean(axis=1) - corners.min(axis=(0, 1))) / cell).astype(np.int64)
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    large = np.ceil(np.log2(np.maximum(longest / cell, 1.0))).astype(np.int64)
    key = large
    for column in where.T:
        key = key * (CELLS + 1) + column
    return np.unique(key, return_inverse=True)[1]


def _of_runs(
    places: np.ndarray, corners: np.ndarray, query: np.ndarray, first: np.ndarray, size: np.ndarray
) -> np.ndarray:
    """Solid angles of runs of triangles at places, summed by place, shape (N,)."""
    total = np.zeros(len(places))
    ends = np.cumsum(size)
    start = 0
    while start < len(size):
        done = ends[start - 1] if start else 0
        stop = max(start + 1, int(np.searchsorted(ends, done + MOST_PAIRS)))
        run = size[start:stop]
        before = np.cumsum(run) - run
        face = np.arange(run.sum()) + np.repeat(first[start:stop] - before, run)
        who = np.repeat(query[start:stop], run)
        a, b, c = (corners[face, k] - places[who] for k in range(3))
        total += np.bincount(who, _solid_angles(a, b, c), len(places))
        start = stop
    return total


def _solid_angles(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> np.ndarray:
    """Of triangles by their corners as seen from the place, shape (P,)."""
    x, y, z = (np.sqrt(np.einsum("ij,ij->i", corner, corner)) for corner in (a, b, c))
    triple = np.einsum("ij,ij->i", a, np.cross(b, c))
    below = (
        x * y * z
        + np.einsum("ij,ij->i", a, b) * z
        + np.einsum("ij,ij->i", b, c) * x
        + np.einsum("ij,ij->i", c, a) * y
    )
    return 2.0 * np.arctan2(triple, below)
