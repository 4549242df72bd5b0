"""Forces of the vertices of one skin as forces of the vertices of another, without lumps.

A force that goes to the triangle nearest to its vertex leaves, on a finer skin, one loaded spot for
each vertex of the coarser one. So it is spread first over the triangles around its vertex, as the
traction that it stands for: force over area, linear between vertices. Patches of these triangles
give their part to the corners of the nearest triangle, in shares that keep it where it acts:

    f'_j = sum over patches p of w_pj a_p sum over corners i of s_pi f_i / A_i

Sums are kept exactly, moments to the distance of the two skins and to where in its triangles a
vertex lies.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from geometry.surface.patches import cut
from geometry.surface.surface import face_areas, vertex_areas_mm2
from sim.forces.shares import shares_on
from workbench.core.result.results import Skin

if TYPE_CHECKING:
    from scipy.sparse import csr_matrix

PATCHES = 3.0
"""Patches to the edge of a triangle of the finer skin."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Spreading:
    """What each vertex of the one skin gives each of the other."""

    matrix: csr_matrix
    """Shares, shape (W, V); of every vertex that is spread they add up to 1."""

    def forces(self, force_N: np.ndarray) -> np.ndarray:
        """Forces (K, V, 3), or scalars (K, V), of the one skin on the other, float32."""
        found = [self.matrix @ np.asarray(frame, np.float64) for frame in force_N]
        return np.array(found, np.float32)


def spreading(source: Skin, target: Skin, vertices: np.ndarray) -> Spreading:
    """How forces go from `source` to `target`.

    Args:
        source: Where forces are known.
        target: Where they are wanted.
        vertices: Which vertices of the source carry any, shape (V,), bool.
    """
    from scipy.sparse import csr_matrix

    size = len(target.points_mm), len(source.points_mm)
    acting = source.faces[vertices[source.faces].any(axis=1)]
    if not len(acting):
        return Spreading(matrix=csr_matrix(size))
    patches = cut(source.points_mm, acting, _patch_mm(source, target))
    shares = shares_on(target, patches.at(source.points_mm))
    area_mm2 = vertex_areas_mm2(source.points_mm, source.faces)[patches.corners]
    given = patches.weights * patches.areas_mm2[:, None] / np.maximum(area_mm2, 1e-12)
    parts = shares.weights[:, :, None] * given[:, None, :]
    rows = np.repeat(shares.corners, 3, axis=1).ravel()
    columns = np.tile(patches.corners, (1, 3)).ravel()
    matrix = csr_matrix((parts.ravel(), (rows, columns)), shape=size)
    return Spreading(matrix=matrix)


def _patch_mm(source: Skin, target: Skin) -> float:
    edges = [np.sqrt(2.0 * np.median(face_areas(s.points_mm, s.faces))) for s in (source, target)]
    return float(min(edges)) / PATCHES
