"""Feather edges: where two sides of a part run together and end in each other.

Two places that face each other across the part lie on planes that meet, unless these are parallel,
in a line. If near that line the sides themselves meet, in a sharp edge or in one corner, the part
runs out there.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.surface.surface import face_normals

SHARP_DEG = 60.0
"""An edge whose sides meet at less is a feather edge [degree]."""
SMOOTH_DEG = 30.0
"""Triangles that meet at less than this from flat are one side [degree]."""
LEAST_SINE = 0.1
"""Of the angle between planes that run together: 6 degrees."""
NEAR_SHARE = 0.35
"""How far from where the planes meet the sides may meet, over the way to there [1]: they bend."""
CORNER_SHARE = 1.6
"""How far from a place its two sides may have a corner in common, over the way to where the planes
meet: a ball may touch a side on its very edge."""
NEAR_MM = 0.05
FLAT_MM = 1e-4
"""Triangles lower than this have no direction [mm]."""
STEP_MM = 0.08
"""Places along sharp edges are so far apart [mm]."""
FAR_MM = 1e6


class Feathers:
    """The sharp edges and sides of a closed mesh."""

    def __init__(self, points_mm: np.ndarray, faces: np.ndarray) -> None:
        """Find them.

        Args:
            points_mm: Vertices [mm], shape (N, 3), float64.
            faces: Triangles, shape (M, 3).
        """
        from scipy.sparse import coo_matrix
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import KDTree

        self._points, self._faces = points_mm, faces
        normals = face_normals(points_mm, faces)
        ends, one, other = _edges(faces)
        bend = np.einsum("ij,ij->i", normals[one], normals[other])
        smooth = bend > np.cos(np.radians(SMOOTH_DEG))
        links = coo_matrix(
            (np.ones(int(smooth.sum())), (one[smooth], other[smooth])), 2 * [len(faces)]
        )
        self._side = connected_components(links, directed=False)[1]
        corners = points_mm[faces]
        across = corners[other].mean(axis=1) - corners[one].mean(axis=1)
        convex = np.einsum("ij,ij->i", across, normals[one]) < 0.0
        whole = _heights_mm(corners) > FLAT_MM
        sharp = (bend < -np.cos(np.radians(SHARP_DEG))) & convex & whole[one] & whole[other]
        chosen = points_mm[ends[sharp]]
        self._sharp = KDTree(_along(chosen[:, 0], chosen[:, 1])) if len(chosen) else None

    def end(self, start: Any, opposite: Any) -> np.ndarray:
        """Whether the part runs out beside each pair of places that face each other, bool, (P,).

        Args:
            start: Places with `points_mm`, `normals` and `face` (-1 where it is not known).
            opposite: As many.
        """
        cosine = np.einsum("ij,ij->i", start.normals, opposite.normals)
        toward = opposite.normals - cosine[:, None] * start.normals
        sine = np.linalg.norm(toward, axis=1)
        gap = np.einsum("ij,ij->i", opposite.points_mm - start.points_mm, opposite.normals)
        tapered = (sine > LEAST_SINE) & (gap > 0.0)
        way_mm = np.where(tapered, gap / np.maximum(sine, LEAST_SINE), 0.0)
        place = start.points_mm + (way_mm / np.maximum(sine, LEAST_SINE))[:, None] * toward
        reach = NEAR_SHARE * way_mm + NEAR_MM
        found = np.zeros(len(sine), dtype=bool)
        if self._sharp is not None:
            found = tapered & (self._sharp.query(place)[0] < reach)
        for row in np.flatnonzero(tapered & ~found & (start.face >= 0) & (opposite.face >= 0)):
            shared = self._shared(int(start.face[row]), int(opposite.face[row]))
            away = np.linalg.norm(shared - start.points_mm[row], axis=1).min(initial=FAR_MM)
            found[row] = away < CORNER_SHARE * way_mm[row] + NEAR_MM
        return found

    def _shared(self, one: int, other: int) -> np.ndarray:
        """Vertices that the sides of two triangles have in common [mm], shape (V, 3)."""
        if self._side[one] == self._side[other]:
            return np.zeros((0, 3))
        first, second = (self._faces[self._side == self._side[face]] for face in (one, other))
        return self._points[np.intersect1d(first, second)]


def _edges(faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Edges of a closed mesh, shape (E, 2), and the two triangles at each, shape (E,)."""
    ends = np.sort(np.stack([faces, np.roll(faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    owner = np.repeat(np.arange(len(faces)), 3)
    pairs = np.lexsort((ends[:, 1], ends[:, 0])).reshape(-1, 2)
    return ends[pairs[:, 0]], owner[pairs[:, 0]], owner[pairs[:, 1]]


def _heights_mm(corners: np.ndarray) -> np.ndarray:
    """Least height of triangles, shape (M,), from their corners, shape (M, 3, 3)."""
    longest_mm = np.linalg.norm(corners - np.roll(corners, -1, axis=1), axis=2).max(axis=1)
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return np.linalg.norm(cross, axis=1) / np.maximum(longest_mm, 1e-300)


def _along(start_mm: np.ndarray, stop_mm: np.ndarray) -> np.ndarray:
    """Places on lines, no farther apart than `STEP_MM`, shape (P, 3)."""
    length = np.linalg.norm(stop_mm - start_mm, axis=1)
    count = np.maximum(2, np.ceil(length / STEP_MM).astype(int) + 1)
    line = np.repeat(np.arange(len(length)), count)
    place = np.arange(len(line)) - np.repeat(np.cumsum(count) - count, count)
    share = (place / (count[line] - 1))[:, None]
    return (1.0 - share) * start_mm[line] + share * stop_mm[line]
