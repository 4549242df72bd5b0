"""Shortest ways on the skin: distance from a vertex, and the direction that leads back to it.

The heat method: let heat flow from the source for a short time, turn its gradient into unit
vectors, and find the function whose gradient they are. The direction toward the source is minus
that function's gradient, constant on each triangle, averaged at the vertices by area and made
tangent to the skin. Source: Crane, Weischedel, Wardetzky, "Geodesics in Heat", ACM TOG 32 (2013);
Sharp, Crane, "A Laplacian for Nonmanifold Triangle Meshes", SGP 2020; both in potpourri3d.

Left out: paths off the skin. Parts of the skin that are not connected with the source have no way
to it: their distance is infinite.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.result.results import Skin

LEAST_GRADIENT = 0.05
"""Length of the mean gradient below which the directions about a vertex cancel [1]: at the source,
and where ways from both sides meet."""
FLOW_TIME = 4.0
"""Time that heat flows in squares of the mean edge [1]. Directions on a cylinder at edges of 0.4 mm
err by 0.65 degree in the median; at 1, the usual value, by 2.1, at 16 by more near the border."""


class SkinWays:
    """Ways on one skin; each connected part is prepared once, when a source first lies on it."""

    def __init__(self, skin: Skin) -> None:
        self._skin = skin
        self._part = _parts(skin)
        self._solvers: dict[int, Any] = {}

    def nearest_vertex(self, point_mm: np.ndarray) -> int:
        """Vertex nearest to a point [mm], shape (3,)."""
        return int(np.argmin(np.linalg.norm(self._skin.points_mm - point_mm, axis=1)))

    def distance_mm(self, source: int) -> np.ndarray:
        """Distance along the skin from a vertex [mm], shape (V,); inf where no way leads.

        Raises:
            DesignError: If the triangles about the source are too poor to compute on.
        """
        part = int(self._part[source])
        vertices = np.flatnonzero(self._part == part)
        row = np.searchsorted(vertices, source)
        found = np.full(len(self._part), np.inf)
        try:
            found[vertices] = self._solver(part, vertices).compute_distance(row)
        except (RuntimeError, ValueError) as error:
            raise DesignError(
                f"no shortest ways can be found on this skin: {error}",
                hint="choose another light model, or a finer skin (meshing.surface_mm)",
                at="optics.light_model",
            ) from error
        return found

    def toward(self, source: int) -> np.ndarray:
        """Unit tangents along the shortest way toward a vertex, shape (V, 3); NaN where none is.

        Raises:
            DesignError: As `distance_mm`.
        """
        skin, distance = self._skin, self.distance_mm(source)
        corners = skin.points_mm[skin.faces].astype(np.float64)
        reached = np.isfinite(distance[skin.faces]).all(axis=1)
        faces, corners = skin.faces[reached], corners[reached]
        total, area = np.zeros_like(skin.points_mm, dtype=np.float64), np.zeros(len(distance))
        gradient, size = _gradients(corners, distance[faces])
        for corner in range(3):
            for axis in range(3):
                total[:, axis] += np.bincount(
                    faces[:, corner], gradient[:, axis] * size, minlength=len(total)
                )
            area += np.bincount(faces[:, corner], size, minlength=len(total))
        mean = -total / np.maximum(area, np.finfo(float).tiny)[:, None]
        mean -= np.einsum("ij,ij->i", mean, skin.normals)[:, None] * skin.normals
        length = np.linalg.norm(mean, axis=1)
        defined = length > LEAST_GRADIENT
        return np.where(defined[:, None], mean / np.where(defined, length, 1.0)[:, None], np.nan)

    def _solver(self, part: int, vertices: np.ndarray) -> Any:
        if part not in self._solvers:
            from potpourri3d import MeshHeatMethodDistanceSolver

            points, faces = submesh(self._skin, vertices)
            self._solvers[part] = MeshHeatMethodDistanceSolver(points, faces, t_coef=FLOW_TIME)
        return self._solvers[part]


def submesh(skin: Skin, vertices: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points and triangles of a connected part, given its vertices in ascending order."""
    number = np.full(len(skin.points_mm), -1, dtype=np.int64)
    number[vertices] = np.arange(len(vertices))
    faces = number[skin.faces]
    points = np.ascontiguousarray(skin.points_mm[vertices], dtype=np.float64)
    return points, faces[(faces >= 0).all(axis=1)]


def _parts(skin: Skin) -> np.ndarray:
    """Number of the connected part that each vertex belongs to, shape (V,)."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components

    count = len(skin.points_mm)
    start, end = skin.faces.ravel(), np.roll(skin.faces, 1, axis=1).ravel()
    graph = coo_array((np.ones(len(start), dtype=np.int8), (start, end)), shape=(count, count))
    return connected_components(graph, directed=False)[1]


def _gradients(corners: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Gradient of a function that is linear on each triangle, (F, 3), and the areas [mm2], (F,).

    grad u = sum of u_i N x e_i / (2 A), with e_i the edge opposite to corner i.
    """
    opposite = np.stack([corners[:, (i + 2) % 3] - corners[:, (i + 1) % 3] for i in range(3)], 1)
    normal = np.cross(opposite[:, 0], opposite[:, 1])
    double = np.maximum(np.linalg.norm(normal, axis=1), np.finfo(float).tiny)
    turned = np.cross((normal / double[:, None])[:, None], opposite)
    return np.einsum("fc,fcd->fd", values, turned) / double[:, None], double / 2.0
