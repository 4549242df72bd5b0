"""Regions carried from one triangulation of a surface to another, and to nodes.

A new face takes labels and numbers of the source face that the normal through its centroid meets
first, to either side: the nearest one, as both lie on the same surface. That is exact where
regions end at an edge of the body; where they end on a smooth face the border follows the new
triangles and wanders by half an edge to both sides, so areas are kept on average.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.rays import RayCaster
from geometry.surface.surface import closest_point
from workbench.core.result.results import NO_NUMBER, LabelledSurface

BACK_MM = 1e-3
"""Rays start this far behind the centroid [mm], or those on the surface itself would miss it."""
REACH = 0.25
"""Hits farther than this share of a face's size are some other part of the body."""


def face_regions(
    source: LabelledSurface, points_mm: np.ndarray, faces: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Labels (F,) uint8 and numbers (F,) int16 of faces (F, 3), from the nearest source faces.

    Args:
        source: Surface whose regions are known.
        points_mm: Vertices of the new triangulation [mm], shape (N, 3).
        faces: Its triangles.
    """
    nearest = nearest_source(source, points_mm, faces)
    return source.labels[nearest], source.numbers[nearest]


def nearest_source(source: LabelledSurface, points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Source face nearest to the centroid of each face, shape (F,), int64."""
    corners = points_mm[faces]
    centre = corners.mean(axis=1)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice_area = np.linalg.norm(normal, axis=1)
    normal /= np.maximum(twice_area, 1e-300)[:, None]
    caster = RayCaster(source.points_mm, source.faces)
    ahead, front, _ = caster.hits(centre - BACK_MM * normal, normal)
    behind, back, _ = caster.hits(centre + BACK_MM * normal, -normal)
    nearest = np.where(ahead < behind, front, back).astype(np.int64)
    limit = REACH * np.sqrt(twice_area) + BACK_MM
    lost = np.flatnonzero(~(np.minimum(ahead, behind) < limit))
    if len(lost):
        nearest[lost] = closest_point(source.points_mm, source.faces, centre[lost])[2]
    return nearest


def node_regions(
    count: int, faces: np.ndarray, labels: np.ndarray, numbers: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Labels and numbers of nodes: all bits of the faces (F, k) that meet there.

    A node between two numbered regions takes the higher number.

    Returns:
        Labels (count,), uint8; numbers (count,), int16.
    """
    node_labels = np.zeros(count, dtype=np.uint8)
    node_numbers = np.full(count, NO_NUMBER, dtype=np.int16)
    for corner in np.asarray(faces).T:
        np.bitwise_or.at(node_labels, corner, labels)
        np.maximum.at(node_numbers, corner, numbers)
    return node_labels, node_numbers
