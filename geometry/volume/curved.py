"""Where rays meet the curved surface that a triangle mesh stands for.

A flat chord of 1 mm lies 0.005 mm inside a finger of radius 15 mm and turns by 4 degrees to the
next: too coarse for mirror-like images. Phong tessellation (Boubekeur and Alexa, 2008) moves each
hit toward the tangent planes of its triangle's corners v_i with normals n_i and weights w_i; with
the factor 1/2 it is exact to third order of the chord's angle on any smooth surface. Written over
the triangle's edges e_ij = v_j - v_i it reads

    p* = p - 1/2 sum_{i<j} w_i w_j m_ij (n_i + n_j),   m_ij = minmod(e_ij . n_i, -e_ij . n_j).

The two arguments are equal on a circular arc. Where they differ, one end's normal is off (where a
cylinder meets its cap it tilts by a degree, times the cylinder's 27 mm), and the smaller is right.
Corners at a crease use the flat normal, so that sharp edges stay sharp. Where a large flat face
meets a small fillet all its corner normals tilt and it would swell like a cushion, so no edge may
bulge by more than the tolerance of the tessellation: m_ij / 4 at its middle.
"""

from __future__ import annotations

import numpy as np

from geometry.body.solid import TOLERANCE_MM
from geometry.surface.rays import RayCaster
from geometry.surface.surface import vertex_normals
from workbench.core.base.errors import MeshingError

CREASE_COSINE = 0.87
"""Corners whose normal is more than 30 degrees off the face's are on a crease."""
NUDGE = 1e-5
"""Turn of a ray that slipped through a corner of the mesh [rad]: 0.0005 mm at 50 mm."""
BACK_MM = 1e-3
"""Lines start this far behind a point [mm], or points on the surface itself would miss it."""
PAIRS = ((0, 1), (1, 2), (2, 0))
NUDGES = ((1.0, 0.3, -0.5), (-0.7, 1.0, 0.4), (0.2, -0.9, 1.0), (-1.0, -0.4, -0.8))


class CurvedSurface:
    """A triangle mesh that answers rays with points of the smooth surface through its vertices."""

    def __init__(
        self, points_mm: np.ndarray, faces: np.ndarray, *, sagitta_mm: float = TOLERANCE_MM
    ) -> None:
        """Prepare rays and corner normals.

        Args:
            points_mm: Vertices [mm], shape (N, 3).
            faces: Triangles, shape (M, 3).
            sagitta_mm: Largest distance of a chord from the surface it stands for.
        """
        self._most_mm = 4.0 * sagitta_mm
        self._caster = RayCaster(points_mm, faces)
        self._corners = np.asarray(points_mm, dtype=np.float64)[faces]
        edges = self._corners[:, 1:] - self._corners[:, :1]
        flat = np.cross(edges[:, 0], edges[:, 1])
        flat /= np.maximum(np.linalg.norm(flat, axis=1, keepdims=True), 1e-300)
        normals = vertex_normals(points_mm, faces)[faces]
        crease = np.einsum("fij,fj->fi", normals, flat) < CREASE_COSINE
        normals = np.where(crease[:, :, None], flat[:, None, :], normals)
        self._bulge = np.stack([self._edge_bulge(normals, i, j) for i, j in PAIRS], axis=1)

    def points(self, origins: np.ndarray, directions: np.ndarray) -> np.ndarray:
        """First point of the smooth surface along each ray [mm], shape (R, 3).

        Raises:
            MeshingError: If a ray misses: the body is not star-shaped as seen from inside.
        """
        distance, face, weights = self._caster.hits(origins, directions)
        for nudge in NUDGES:
            lost = np.flatnonzero(face < 0)
            if not len(lost):
                break
            turned = directions[lost] + NUDGE * np.asarray(nudge)
            distance[lost], face[lost], weights[lost] = self._caster.hits(origins[lost], turned)
        lost = np.flatnonzero(face < 0)
        if len(lost):
            where = np.round(origins[lost[0]], 2).tolist()
            raise MeshingError(
                f"{len(lost)} of {len(face)} rays from inside miss the wall, one from {where} mm",
                hint="this shape cannot be meshed by layers; make it rounder or the wall thicker",
                at="shape",
            )
        return self._smooth(face, weights)

    def beside(
        self, points_mm: np.ndarray, normals: np.ndarray, reach_mm: float
    ) -> tuple[np.ndarray, np.ndarray]:
        """Nearest point of the smooth surface along each line through a point, to either side.

        Args:
            points_mm: Points near the surface [mm], shape (R, 3).
            normals: Unit directions of the lines, shape (R, 3).
            reach_mm: Largest distance that counts as near.

        Returns:
            Points [mm], shape (R, 3), where nothing is near the ones given; whether something is
            near, shape (R,), bool.
        """
        ahead = self._caster.hits(points_mm - BACK_MM * normals, normals)
        behind = self._caster.hits(points_mm + BACK_MM * normals, -normals)
        first = ahead[0] < behind[0]
        face = np.where(first, ahead[1], behind[1])
        weights = np.where(first[:, None], ahead[2], behind[2])
        near = np.minimum(ahead[0], behind[0]) < reach_mm + BACK_MM
        moved = np.array(points_mm, dtype=np.float64)
        moved[near] = self._smooth(face[near], weights[near])
        return moved, near

    def _smooth(self, face: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """Points of the smooth surface at corner weights (R, 3) of faces (R,), shape (R, 3)."""
        flat = np.einsum("ri,rij->rj", weights, self._corners[face])
        pairs = np.stack([weights[:, i] * weights[:, j] for i, j in PAIRS], axis=1)
        return flat + np.einsum("rp,rpj->rj", pairs, self._bulge[face])

    def _edge_bulge(self, normals: np.ndarray, i: int, j: int) -> np.ndarray:
        """-1/2 m_ij (n_i + n_j) of one edge of every face, shape (M, 3)."""
        edge = self._corners[:, j] - self._corners[:, i]
        here = np.einsum("fk,fk->f", edge, normals[:, i])
        there = -np.einsum("fk,fk->f", edge, normals[:, j])
        smaller = np.where(np.abs(here) < np.abs(there), here, there)
        minmod = np.where(here * there > 0.0, smaller, 0.0).clip(-self._most_mm, self._most_mm)
        return -0.5 * minmod[:, None] * (normals[:, i] + normals[:, j])
