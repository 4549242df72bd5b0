"""Triangles cut into small patches, and what is linear on the triangles summed over them.

A triangle whose longest edge is L is cut into n^2 alike, n = ceil(L / edge). At the centroid of
each a linear field has its mean, so that the sum over patches of value times area is exactly the
integral over the triangle.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class Patches:
    """Small pieces of triangles."""

    parent: np.ndarray
    """Triangle that each is a piece of, shape (S,)."""
    corners: np.ndarray
    """Vertices of that triangle, shape (S, 3)."""
    weights: np.ndarray
    """Shares of these vertices in its centroid, shape (S, 3), sum 1."""
    areas_mm2: np.ndarray
    """Shape (S,)."""

    def at(self, values: np.ndarray) -> np.ndarray:
        """Values of the vertices (V, C) at the centroids, (S, C)."""
        return np.einsum("sk,skc->sc", self.weights, values[self.corners])


def cut(points_mm: np.ndarray, faces: np.ndarray, edge_mm: float) -> Patches:
    """Cut triangles (M, 3) of points (V, 3) into patches no longer than `edge_mm`."""
    a, b, c = (np.asarray(points_mm, np.float64)[faces[:, k]] for k in range(3))
    edges = np.stack([b - a, c - b, a - c])
    longest_mm = np.linalg.norm(edges, axis=2).max(axis=0)
    area_mm2 = 0.5 * np.linalg.norm(np.cross(b - a, c - a), axis=1)
    pieces = np.maximum(np.ceil(longest_mm / edge_mm - 1e-9), 1.0).astype(np.int64)
    parents, weights = [np.zeros(0, np.int64)], [np.zeros((0, 3))]
    for count in np.unique(pieces):
        own = np.flatnonzero(pieces == count)
        places = _centroids(int(count))
        parents.append(np.repeat(own, len(places)))
        weights.append(np.tile(places, (len(own), 1)))
    parent = np.concatenate(parents)
    return Patches(
        parent=parent,
        corners=faces[parent],
        weights=np.concatenate(weights),
        areas_mm2=(area_mm2 / pieces**2)[parent],
    )


@cache
def _centroids(count: int) -> np.ndarray:
    """Barycentric centroids of the count^2 pieces of a triangle, shape (count^2, 3)."""
    i, j = (each.ravel() for each in np.meshgrid(range(count), range(count), indexing="ij"))
    upward, downward = i + j < count, i + j < count - 1
    places = np.concatenate(
        [
            np.column_stack([i[upward], j[upward]]) + 1.0 / 3.0,
            np.column_stack([i[downward], j[downward]]) + 2.0 / 3.0,
        ]
    )
    places /= count
    return np.column_stack([1.0 - places.sum(axis=1), places])
