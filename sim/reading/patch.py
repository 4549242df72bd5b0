"""The part of a skin that a photograph is fitted on: free vertices, and those around them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.raster.gbuffer import sum_area_vectors
from sim.reading.rest_skin import RestSkin

TINY_MM2 = 1e-9


@dataclass(frozen=True, kw_only=True, slots=True)
class Posed:
    """A patch moved inward."""

    tilts: np.ndarray
    """Parts of the inward normals across those at rest, shape (n, 2)."""
    normals: np.ndarray
    """Inward unit normals, shape (n, 3)."""
    sizes_mm2: np.ndarray
    """Length of |A0| n0 + A - A0, shape (n,)."""
    corners_mm: np.ndarray
    """Of the triangles, shape (f, 3, 3)."""


class Patch:
    """n vertices of f triangles, of which the first m are free to move inward."""

    def __init__(self, skin: RestSkin, free: np.ndarray) -> None:
        """Take the triangles that touch free vertices.

        Args:
            skin: The skin at rest.
            free: Which vertices may move, shape (V,), bool.
        """
        self.triangles = np.flatnonzero(free[skin.faces].any(axis=1))
        """Numbers of the triangles, shape (f,)."""
        touched = np.zeros(skin.count, dtype=bool)
        touched[skin.faces[self.triangles]] = True
        held = np.flatnonzero(touched & ~free)
        self.vertices = np.concatenate([np.flatnonzero(free), held])
        """Numbers of the vertices, the free ones first, shape (n,)."""
        self.free = int(np.count_nonzero(free))
        """m."""
        local = np.full(skin.count, -1)
        local[self.vertices] = np.arange(len(self.vertices))
        self.faces = local[skin.faces[self.triangles]]
        """Triangles by numbers within the patch, shape (f, 3)."""
        self.inward = skin.inward[self.vertices]
        self.across = np.stack([skin.one[self.vertices], skin.two[self.vertices]], axis=1)
        self.side = skin.side[self.vertices]
        self._rest_mm = skin.points_mm[self.vertices]
        self._rest_area_mm2 = sum_area_vectors(self._rest_mm, self.faces, self.count)
        size_mm2 = np.linalg.norm(skin.area_mm2[self.vertices], axis=1, keepdims=True)
        self._rest_mm2 = size_mm2 * self.inward
        self._triangle_pattern = _Pattern(self.faces, self.free)
        """Where derivatives by moves of corners belong."""

    @property
    def count(self) -> int:
        """n."""
        return len(self.vertices)

    def posed(self, inward_mm: np.ndarray) -> Posed:
        """The patch with its free vertices moved inward by (m,) [mm]."""
        moved_mm = self._rest_mm.copy()
        moved_mm[: self.free] += inward_mm[:, None] * self.inward[: self.free]
        corners_mm = moved_mm[self.faces]
        change = sum_area_vectors(moved_mm, self.faces, self.count) - self._rest_area_mm2
        turned = self._rest_mm2 + self.side[:, None] * change
        sizes = np.maximum(np.linalg.norm(turned, axis=1), TINY_MM2)
        normals = turned / sizes[:, None]
        return Posed(
            tilts=np.einsum("nac,nc->na", self.across, normals),
            normals=normals,
            sizes_mm2=sizes,
            corners_mm=corners_mm,
        )

    def tilt_slopes(self, posed: Posed):
        """Derivatives of the tilts by the moves [1/mm], sparse (2 n, m).

        Rows 2 v and 2 v + 1 are those of vertex v. With d A_f / d x_j = (x_j+1 - x_j+2) x / 2,
        d p = (one - p n) . dA / |turned|.
        """
        across = self.across - posed.tilts[:, :, None] * posed.normals[:, None, :]
        across *= (self.side / posed.sizes_mm2)[:, None, None]
        values = np.empty((len(self.faces), 3, 3, 2))
        for corner in range(3):
            edge = posed.corners_mm[:, (corner + 1) % 3] - posed.corners_mm[:, (corner + 2) % 3]
            swept = 0.5 * np.cross(self.inward[self.faces[:, corner]], edge)
            for of in range(3):
                values[:, of, corner] = np.einsum("fac,fc->fa", across[self.faces[:, of]], swept)
        return self._triangle_pattern.filled(values)


class _Pattern:
    """A sparse matrix (2 n, m) whose places are known: two rows for each vertex of a triangle."""

    def __init__(self, faces: np.ndarray, free: int) -> None:
        count = int(faces.max(initial=-1)) + 1
        of = np.repeat(faces[:, :, None], 3, axis=2)
        by = np.repeat(faces[:, None, :], 3, axis=1)
        self._kept = by < free
        rows = 2 * of[self._kept][:, None] + np.arange(2)
        places = rows * free + by[self._kept][:, None]
        unique, self._at = np.unique(places.ravel(), return_inverse=True)
        self._columns = unique % free
        self._starts = np.searchsorted(unique // free, np.arange(2 * count + 1))
        self._shape = (2 * count, free)

    def filled(self, values: np.ndarray):
        """The matrix of values (f, 3, 3, 2): of a vertex, by the move of another, both tilts."""
        from scipy.sparse import csr_matrix

        data = np.bincount(self._at, values[self._kept].ravel(), minlength=len(self._columns))
        return csr_matrix((data, self._columns, self._starts), self._shape)
