"""Places spread evenly over a mesh."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

SAMPLES = 2000
"""Places, unless more are asked for."""


class Spread(NamedTuple):
    """Evenly spread places on a surface."""

    points_mm: np.ndarray
    """Shape (S, 3)."""
    normals: np.ndarray
    """Unit normals, shape (S, 3)."""
    area_mm2: float
    """Area of the whole surface."""


def spread(points_mm: np.ndarray, faces: np.ndarray, count: int = SAMPLES) -> Spread:
    """Places on a mesh, each for the same share of its area.

    Source: Roberts, The unreasonable effectiveness of quasirandom sequences, 2018 (R2 sequence).
    """
    corners = np.asarray(points_mm, dtype=np.float64)[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1)
    normal = cross / np.maximum(area, 1e-300)[:, None]
    face = np.searchsorted(np.cumsum(area) / area.sum(), (np.arange(count) + 0.5) / count)
    face = np.minimum(face, len(faces) - 1)
    place = (0.5 + np.outer(np.arange(count), [0.7548776662, 0.5698402910])) % 1.0
    folded = np.where(place.sum(axis=1, keepdims=True) > 1.0, 1.0 - place, place)
    weights = np.column_stack([1.0 - folded.sum(axis=1), folded])
    points = np.einsum("si,sij->sj", weights, corners[face])
    return Spread(points_mm=points, normals=normal[face], area_mm2=float(area.sum() / 2))
