"""Points that carry surface forces: contact on the outer skin, bonding on the inner skin.

The points are the skin's vertices, each with a third of the area around it: vertices lie on the
true surface, while centroids of facets sag below it by as much as the allowed overlap. Triangles
longer than a cell are halved first, and more under a sharp indenter (`refinement`). A point's
spring is penalty * E / grid per area.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core.results import Skin


@dataclass(frozen=True, kw_only=True, slots=True)
class SurfacePoints:
    """P points on the skins, sensor frame."""

    position_mm: np.ndarray
    """Undeformed position [mm], shape (P, 3), float64."""
    stiffness_N_mm: np.ndarray
    """Spring of the point [N/mm], shape (P,)."""
    axis: np.ndarray
    """Unit normal of the skin around the point, shape (P, 3)."""
    sideways: np.ndarray
    """Spring across the axis over that along it, of a held point; at most 1. Shape (P,)."""
    bonded: np.ndarray
    """True: held at its place (inner skin). False: may meet the indenter. Shape (P,), bool."""
    vertex: np.ndarray
    """Vertex of its own skin at or next to the point, shape (P,), int64."""

    def take(self, chosen: np.ndarray) -> SurfacePoints:
        """The chosen points, by index or mask."""
        return SurfacePoints(
            position_mm=self.position_mm[chosen],
            stiffness_N_mm=self.stiffness_N_mm[chosen],
            axis=self.axis[chosen],
            sideways=self.sideways[chosen],
            bonded=self.bonded[chosen],
            vertex=self.vertex[chosen],
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Facets:
    """Triangles of a skin, whole or in pieces."""

    points_mm: np.ndarray
    """Corners [mm], shape (N, 3)."""
    triangles: np.ndarray
    """Corners of each triangle, shape (T, 3), int64."""
    vertex: np.ndarray
    """Vertex of the skin at or next to each corner, shape (N,)."""

    def corners_mm(self) -> np.ndarray:
        """Corners of each triangle [mm], shape (T, 3, 3)."""
        return self.points_mm[self.triangles]

    def longest_edges_mm(self) -> np.ndarray:
        """Longest edge of each triangle [mm], shape (T,)."""
        corners = self.corners_mm()
        return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)

    def halve(self, chosen: np.ndarray) -> Facets:
        """The chosen triangles as four; a midpoint belongs to the first end of its edge.

        Neighbours that are kept whole do not learn of the midpoints: areas stay exact.
        """
        triangles = self.triangles[chosen]
        edges = np.sort(np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2), axis=2)
        ends, middle = np.unique(edges.reshape(-1, 2), axis=0, return_inverse=True)
        a, b, c = triangles.T
        ab, bc, ca = (middle.reshape(-1, 3) + len(self.points_mm)).T
        pieces = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        quarters = [np.stack(piece, axis=1) for piece in pieces]
        whole = np.delete(self.triangles, chosen, axis=0)
        return Facets(
            points_mm=np.concatenate([self.points_mm, self.points_mm[ends].mean(axis=1)]),
            triangles=np.concatenate([whole, *quarters]),
            vertex=np.concatenate([self.vertex, self.vertex[ends[:, 0]]]),
        )


def facets_of(skin: Skin, faces: np.ndarray, *, spacing_mm: float) -> Facets:
    """Some triangles of a skin, by index, halved until most have no longer edge."""
    facets = Facets(
        points_mm=skin.points_mm,
        triangles=skin.faces[faces].astype(np.int64),
        vertex=np.arange(len(skin.points_mm)),
    )
    while len(faces) and np.median(facets.longest_edges_mm()) > spacing_mm:
        facets = facets.halve(np.arange(len(facets.triangles)))
    return facets


def corner_points(
    facets: Facets, *, stiffness_N_mm3: float, bonded: bool, sideways: float = 1.0
) -> SurfacePoints:
    """Points at the corners of triangles.

    Args:
        facets: The triangles.
        stiffness_N_mm3: Spring per area, along the skin's normal.
        bonded: Whether the points are held.
        sideways: Spring in the skin's plane over that along its normal.
    """
    points, triangles = facets.points_mm, facets.triangles
    corners = facets.corners_mm()
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    third = np.repeat(np.linalg.norm(normal, axis=1) / 6.0, 3)
    area = np.bincount(triangles.ravel(), third, len(points))
    used = np.flatnonzero(area > 0.0)
    axis = _column_sums(triangles.ravel(), np.repeat(normal, 3, axis=0), len(points))
    return SurfacePoints(
        position_mm=points[used],
        stiffness_N_mm=stiffness_N_mm3 * area[used],
        axis=_unit(axis[used]),
        sideways=np.full(len(used), sideways),
        bonded=np.full(len(used), bonded),
        vertex=facets.vertex[used],
    )


def join(first: SurfacePoints, second: SurfacePoints) -> SurfacePoints:
    """Points of both sets."""
    return SurfacePoints(
        position_mm=np.concatenate([first.position_mm, second.position_mm]),
        stiffness_N_mm=np.concatenate([first.stiffness_N_mm, second.stiffness_N_mm]),
        axis=np.concatenate([first.axis, second.axis]),
        sideways=np.concatenate([first.sideways, second.sideways]),
        bonded=np.concatenate([first.bonded, second.bonded]),
        vertex=np.concatenate([first.vertex, second.vertex]),
    )


def merge(points: SurfacePoints, grid_mm: float) -> SurfacePoints:
    """One point per grid cell: the stiffness-weighted mean of those in it.

    A bond needs no more points than the grid has freedoms; fewer points cost less per substep.
    Vertex and spring sideways of a merged point are those of its first member.
    """
    cell = np.round(points.position_mm / grid_mm).astype(np.int64)
    _, first, group = np.unique(cell, axis=0, return_index=True, return_inverse=True)
    stiffness = np.bincount(group.ravel(), points.stiffness_N_mm)
    weight = points.stiffness_N_mm[:, None]
    centre = _column_sums(group.ravel(), weight * points.position_mm, len(stiffness))
    axis = _column_sums(group.ravel(), weight * points.axis, len(stiffness))
    return SurfacePoints(
        position_mm=centre / stiffness[:, None],
        stiffness_N_mm=stiffness,
        axis=_unit(axis),
        sideways=points.sideways[first],
        bonded=points.bonded[first],
        vertex=points.vertex[first],
    )


def _column_sums(group: np.ndarray, vectors: np.ndarray, count: int) -> np.ndarray:
    """Sums of vectors (N, 3) by group (N,), shape (count, 3)."""
    return np.stack([np.bincount(group, vectors[:, c], count) for c in range(3)], axis=1)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
