"""The place of a surface that is nearest to a point: on its triangles, not at their corners.

A straight wall has corners only at its ends, so a nearest corner may lie far from what was meant.
The normal there is that of the smooth surface which the triangles stand for: at each corner of the
triangle the normals of the faces about it that meet at less than `CREASE_DEG` are averaged, and the
three averages are blended. On a long flat face that is the face's own normal, also beside a sharp
edge; on a curved tip it turns evenly.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from geometry.surface.surface import closest_on_triangles
from workbench.core.result.results import Skin

CREASE_DEG = 40.0
"""Angle between faces from which an edge is meant; the rounds of tessellated bodies turn less."""


class SkinPlace(NamedTuple):
    """The nearest place of a surface."""

    point_mm: np.ndarray
    """On a triangle, shape (3,)."""
    distance_mm: float
    """From what was asked for to the surface."""
    face: int
    """The triangle."""
    normal: np.ndarray
    """Unit normal of the smooth surface, shape (3,)."""


def place_near(
    points_mm: np.ndarray, faces: np.ndarray, query_mm: np.ndarray | tuple[float, float, float]
) -> SkinPlace:
    """The place of a surface nearest to one point.

    All triangles whose box is no farther than the nearest corner are looked at, which for one point
    is quicker than a search tree.

    Args:
        points_mm: Vertices, shape (N, 3).
        faces: Triangles counter-clockwise from outside, shape (M, 3), at least one.
        query_mm: The point, shape (3,).
    """
    query = np.asarray(query_mm, dtype=np.float64)
    a, b, c = (np.asarray(points_mm, dtype=np.float64)[faces[:, k]] - query for k in range(3))
    low, high = np.minimum(np.minimum(a, b), c), np.maximum(np.maximum(a, b), c)
    beside = np.maximum(np.maximum(low, -high), 0.0)
    box_2 = np.einsum("fc,fc->f", beside, beside)
    near = np.flatnonzero(box_2 <= np.einsum("fc,fc->f", a, a).min())
    corners = np.stack([a[near], b[near], c[near]], axis=1)
    found = closest_on_triangles(np.zeros((len(near), 3)), corners)
    distance_mm = np.linalg.norm(found, axis=1)
    best = int(np.argmin(distance_mm))
    face = int(near[best])
    normals = np.array([_corner_normal(points_mm, faces, face, k) for k in faces[face]])
    normal = blended(corners[best], normals, found[best])
    return SkinPlace(found[best] + query, float(distance_mm[best]), face, normal)


def _corner_normal(points_mm: np.ndarray, faces: np.ndarray, face: int, corner: int) -> np.ndarray:
    """Normal at a corner of a face as seen from that face: beyond an edge nothing counts."""
    about = faces[(faces == corner).any(axis=1)]
    ends = np.asarray(points_mm, dtype=np.float64)[np.vstack([faces[face], about])]
    normals = np.cross(ends[:, 1] - ends[:, 0], ends[:, 2] - ends[:, 0])
    units = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    smooth = units[1:] @ units[0] > math.cos(math.radians(CREASE_DEG))
    # A face without an area of its own has no normal: then all about it count.
    normal = normals[1:][smooth if smooth.any() else slice(None)].sum(axis=0)
    return normal / max(float(np.linalg.norm(normal)), 1e-300)


def blended(corners_mm: np.ndarray, normals: np.ndarray, point_mm: np.ndarray) -> np.ndarray:
    """Unit normal at a point of a triangle from the unit normals of its corners, shape (3,)."""
    shares, *_ = np.linalg.lstsq(
        np.vstack([corners_mm.T, np.ones(3)]), np.append(point_mm, 1.0), rcond=None
    )
    normal = np.clip(shares, 0.0, 1.0) @ normals
    return normal / np.linalg.norm(normal)


def smooth_normal(skin: Skin, face: int, point_mm: np.ndarray) -> np.ndarray:
    """Unit vertex normal of a skin interpolated at a point of a triangle, shape (3,)."""
    corners = skin.faces[face]
    return blended(skin.points_mm[corners], skin.normals[corners], point_mm)
