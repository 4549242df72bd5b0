"""The skin at rest as a camera sees it, and how its normals follow from moving it inward.

A vertex moved by h along its inward normal n0 has the normal of the renderer,

    n = unit(|A0| n0 + A(h) - A0),

with A the sum of the area vectors of its triangles, A_f = (x1 - x0) x (x2 - x0) / 2. Normals of a
moved skin thus belong to a surface, whatever h is: nothing has to be integrated.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.maps.signal import tangents
from sim.optics.raster.gbuffer import sum_area_vectors
from sim.optics.raster.skin_view import SkinView

LEAST_AREA_MM2 = 1e-4
"""Least area that a vertex counts for."""
COTANGENTS = (0.02, 5.0)
"""Range of the cotangents of a triangle: slivers count as less slender."""


@dataclass(frozen=True, kw_only=True)
class RestSkin:
    """V vertices and F triangles, numbered as the renderer numbers them."""

    points_mm: np.ndarray
    """Shape (V, 3), float64."""
    faces: np.ndarray
    """Shape (F, 3)."""
    inward: np.ndarray
    """Unit normals into the sensor, shape (V, 3)."""
    one: np.ndarray
    """Unit vectors across them, shape (V, 3)."""
    two: np.ndarray
    """The same, across both."""
    area_mm2: np.ndarray
    """Sums of area vectors, turned inward, shape (V, 3)."""
    side: np.ndarray
    """1 where triangles turn inward, else -1, shape (V,)."""

    @property
    def count(self) -> int:
        """V."""
        return len(self.points_mm)

    @property
    def shares_mm2(self) -> np.ndarray:
        """Area that each vertex stands for [mm2], shape (V,)."""
        return np.maximum(np.linalg.norm(self.area_mm2, axis=1) / 3.0, LEAST_AREA_MM2)


def open_rest_skin(view: SkinView) -> RestSkin:
    """The skin of a view."""
    points_mm = view.points_mm.astype(np.float64)
    faces = view.faces.astype(np.int64)
    inward = -view.normals.astype(np.float64)
    one, two = tangents(inward)
    area_mm2 = sum_area_vectors(points_mm, faces, len(points_mm))
    side = np.where(np.einsum("vc,vc->v", area_mm2, inward) < 0.0, -1.0, 1.0)
    return RestSkin(
        points_mm=points_mm,
        faces=faces,
        inward=inward,
        one=one,
        two=two,
        area_mm2=side[:, None] * area_mm2,
        side=side,
    )


def neighbours(skin: RestSkin):
    """Which vertices share an edge, sparse (V, V), of ones."""
    from scipy.sparse import coo_matrix

    edges = np.concatenate([skin.faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    ends = np.concatenate([edges, edges[:, ::-1]]).T
    found = coo_matrix((np.ones(ends.shape[1]), ends), (skin.count, skin.count)).tocsr()
    found.data[:] = 1.0
    return found


def bending(skin: RestSkin):
    """The Laplacian of a function on the skin [1/mm2], sparse (V, V), by cotangents.

    Source: Meyer, Desbrun, Schroeder and Barr, Discrete differential-geometry operators, 2003.
    """
    from scipy.sparse import coo_matrix, diags

    corners = skin.points_mm[skin.faces]
    rows, columns, weights = [], [], []
    for here, after, before in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        to_one = corners[:, after] - corners[:, here]
        to_other = corners[:, before] - corners[:, here]
        sine = np.linalg.norm(np.cross(to_one, to_other), axis=1)
        cotangent = np.einsum("fc,fc->f", to_one, to_other) / np.maximum(sine, 1e-12)
        weight = np.clip(cotangent, *COTANGENTS) / 2.0
        ends = skin.faces[:, after], skin.faces[:, before]
        rows += ends
        columns += ends[::-1]
        weights += [weight, weight]
    size = (skin.count, skin.count)
    linked = coo_matrix(
        (np.concatenate(weights), (np.concatenate(rows), np.concatenate(columns))), size
    ).tocsr()
    return diags(1.0 / skin.shares_mm2) @ (diags(np.asarray(linked.sum(axis=1)).ravel()) - linked)


def normals_of(skin: RestSkin, displacement_mm: np.ndarray) -> np.ndarray:
    """Inward unit normals of the skin displaced by (V, 3) [mm], shape (V, 3)."""
    faces = skin.faces[displacement_mm.any(axis=1)[skin.faces].any(axis=1)]  # pyright: ignore[reportIndexIssue]
    moved_mm2 = sum_area_vectors(skin.points_mm + displacement_mm, faces, skin.count)
    change = moved_mm2 - sum_area_vectors(skin.points_mm, faces, skin.count)
    turned = np.linalg.norm(skin.area_mm2, axis=1, keepdims=True) * skin.inward
    turned += skin.side[:, None] * change
    return turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
