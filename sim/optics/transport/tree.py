"""A tree of boxes over triangles, for drivers without Embree.

The tree is a full binary one: node i has the children 2 i and 2 i + 1, the root is 1. Each node's
triangles are halved at the median along the longest side of their centres' box, all nodes of a
level at once. Leaf j of `depth` levels holds the triangles between two entries of `starts`. On
even meshes the median is within a third of the surface area heuristic, and builds in milliseconds.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

LEAF = 4
"""Most triangles in a leaf."""
MARGIN_MM = 1e-4
"""Boxes are this much larger than what they hold [mm]: more than single precision loses."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Tree:
    """Boxes and the order of triangles in the leaves."""

    lower_mm: np.ndarray
    """Low corners of the boxes of nodes 0 .. 2 leaves - 1; 0 is not used; (2 leaves, 3), f32."""
    upper_mm: np.ndarray
    """High corners, shape (2 leaves, 3), float32."""
    starts: np.ndarray
    """First triangle in `order` of each leaf, and the end, shape (leaves + 1,), int32."""
    order: np.ndarray
    """Triangles as the leaves hold them, shape (F,), int32."""


def build_tree(points_mm: np.ndarray, faces: np.ndarray) -> Tree:
    """The tree of a triangle mesh: points (N, 3), faces (F, 3)."""
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    low, high = corners.min(axis=1), corners.max(axis=1)
    centre = 0.5 * (low + high)
    count = len(faces)
    leaves = 1
    while leaves * LEAF < count:
        leaves *= 2
    order = np.arange(count)
    parts = 1
    while parts < leaves:
        starts = _starts(count, parts)
        owner = np.repeat(np.arange(parts), np.diff(starts))
        here = centre[order]
        extent = np.maximum.reduceat(here, starts[:-1]) - np.minimum.reduceat(here, starts[:-1])
        key = np.take_along_axis(here, extent.argmax(axis=1)[owner][:, None], axis=1)[:, 0]
        order = order[np.lexsort((key, owner))]
        parts *= 2
    starts = _starts(count, leaves)
    lower, upper = np.empty((2 * leaves, 3)), np.empty((2 * leaves, 3))
    lower[leaves:] = np.minimum.reduceat(low[order], starts[:-1])
    upper[leaves:] = np.maximum.reduceat(high[order], starts[:-1])
    for level in range(leaves.bit_length() - 2, -1, -1):
        nodes = np.arange(1 << level, 2 << level)
        lower[nodes] = np.minimum(lower[2 * nodes], lower[2 * nodes + 1])
        upper[nodes] = np.maximum(upper[2 * nodes], upper[2 * nodes + 1])
    lower[0], upper[0] = lower[1], upper[1]
    return Tree(
        lower_mm=(lower - MARGIN_MM).astype(np.float32),
        upper_mm=(upper + MARGIN_MM).astype(np.float32),
        starts=starts.astype(np.int32),
        order=order.astype(np.int32),
    )


def _starts(count: int, parts: int) -> np.ndarray:
    """Where each of equal parts begins; halving a part gives two parts of the next level."""
    return np.arange(parts + 1, dtype=np.int64) * count // parts
