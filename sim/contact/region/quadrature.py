"""Points that carry surface forces: contact on the outer skin, bonding on the inner skin.

The points are the skin's vertices, each with a third of the area around it: vertices lie on the
true surface, while centroids of facets sag below it by as much as the allowed overlap. Triangles
longer than a cell are halved first, and more under a sharp indenter (`refinement`). A point's
spring is penalty * E / grid per area.
"""

from __future__ import annotations

from dataclasses import dataclass, fields, replace

import numpy as np

from workbench.core.result.results import Skin

UNDRIVEN = -1
"""Drive of a point that no actuation moves."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SurfacePoints:
    """P points on the skins, sensor frame."""

    position_mm: np.ndarray
    """Undeformed position [mm], shape (P, 3), float64."""
    area_mm2: np.ndarray
    """Undeformed area that the point stands for [mm2], shape (P,)."""
    stiffness_N_mm: np.ndarray
    """Spring of the point [N/mm], shape (P,)."""
    axis: np.ndarray
    """Unit normal of the skin around the point, shape (P, 3)."""
    sideways: np.ndarray
    """Spring across the axis over that along it, of a held point; at most 1. Shape (P,)."""
    bonded: np.ndarray
    """True: held at its place or driven. False: may meet the indenter. Shape (P,), bool."""
    drive: np.ndarray
    """Which actuation of the press drives a held point, else -1, shape (P,), int64."""
    vertices: np.ndarray
    """The three vertices of its own skin around the point, shape (P, 3), int64."""
    shares: np.ndarray
    """Share of each of them in the point; they sum to 1. Shape (P, 3)."""

    def take(self, chosen: np.ndarray) -> SurfacePoints:
        """The chosen points, by index or mask."""
        return SurfacePoints(**{f.name: getattr(self, f.name)[chosen] for f in fields(self)})

    def scaled(self, factors: np.ndarray) -> SurfacePoints:
        """The same points with springs multiplied by factors, shape (P,)."""
        return replace(self, stiffness_N_mm=factors * self.stiffness_N_mm)

    @property
    def count(self) -> int:
        """P."""
        return len(self.position_mm)

    def to_vertices(self, values: np.ndarray, count: int) -> np.ndarray:
        """Share values at the points, (P,) or (P, C), out to the skin's vertices, (count, ...).

        The sum over the vertices is that over the points.
        """
        columns = values.reshape(len(values), -1)
        shared = self.shares[:, :, None] * columns[:, None, :]
        totals = _column_sums(self.vertices.ravel(), shared.reshape(-1, columns.shape[1]), count)
        return totals.reshape(count, *values.shape[1:])


@dataclass(frozen=True, kw_only=True, slots=True)
class Facets:
    """Triangles of a skin, whole or in pieces."""

    points_mm: np.ndarray
    """Corners [mm], shape (N, 3)."""
    triangles: np.ndarray
    """Corners of each triangle, shape (T, 3), int64."""
    parent: np.ndarray
    """Triangle of the skin that each triangle is a piece of, shape (T,), int64."""
    skin: Skin
    """The skin they are cut from."""

    def corners_mm(self) -> np.ndarray:
        """Corners of each triangle [mm], shape (T, 3, 3)."""
        return self.points_mm[self.triangles]

    def longest_edges_mm(self) -> np.ndarray:
        """Longest edge of each triangle [mm], shape (T,)."""
        corners = self.corners_mm()
        return np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)

    def halve(self, chosen: np.ndarray) -> Facets:
        """The chosen triangles as four.

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
        parents = np.tile(self.parent[chosen], 4)
        return Facets(
            points_mm=np.concatenate([self.points_mm, self.points_mm[ends].mean(axis=1)]),
            triangles=np.concatenate([whole, *quarters]),
            parent=np.concatenate([np.delete(self.parent, chosen), parents]),
            skin=self.skin,
        )


def facets_of(skin: Skin, faces: np.ndarray, *, spacing_mm: float) -> Facets:
    """Some triangles of a skin, by index, halved until most have no longer edge."""
    facets = Facets(
        points_mm=skin.points_mm,
        triangles=skin.faces[faces].astype(np.int64),
        parent=np.asarray(faces, dtype=np.int64),
        skin=skin,
    )
    while len(faces) and np.median(facets.longest_edges_mm()) > spacing_mm:
        facets = facets.halve(np.arange(len(facets.triangles)))
    return facets


def corner_points(
    facets: Facets,
    *,
    stiffness_N_mm3: float,
    bonded: bool,
    sideways: float = 1.0,
    drive: int = UNDRIVEN,
) -> SurfacePoints:
    """Points at the corners of triangles.

    Args:
        facets: The triangles.
        stiffness_N_mm3: Spring per area, along the skin's normal.
        bonded: Whether the points are held.
        sideways: Spring in the skin's plane over that along its normal.
        drive: Which actuation drives them.
    """
    points, triangles = facets.points_mm, facets.triangles
    corners = facets.corners_mm()
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    third = np.repeat(np.linalg.norm(normal, axis=1) / 6.0, 3)
    area = np.bincount(triangles.ravel(), third, len(points))
    used = np.flatnonzero(area > 0.0)
    axis = _column_sums(triangles.ravel(), np.repeat(normal, 3, axis=0), len(points))
    parent = np.zeros(len(points), np.int64)
    parent[triangles.ravel()] = np.repeat(facets.parent, 3)
    vertices = facets.skin.faces[parent[used]].astype(np.int64)
    return SurfacePoints(
        position_mm=points[used],
        area_mm2=area[used],
        stiffness_N_mm=stiffness_N_mm3 * area[used],
        axis=_unit(axis[used]),
        sideways=np.full(len(used), sideways),
        bonded=np.full(len(used), bonded),
        drive=np.full(len(used), drive),
        vertices=vertices,
        shares=_barycentric(points[used], facets.skin.points_mm[vertices]),
    )


def _barycentric(points: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Shares of the corners (P, 3, 3) of triangles in points on them (P, 3), shape (P, 3)."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    square = np.maximum(np.einsum("pc,pc->p", normal, normal), 1e-30)
    found = []
    for corner in range(3):
        a, b = corners[:, (corner + 1) % 3], corners[:, (corner + 2) % 3]
        part = np.cross(b - a, points - a)
        found.append(np.einsum("pc,pc->p", part, normal) / square)
    shares = np.clip(np.stack(found, axis=1), 0.0, 1.0)
    return shares / np.maximum(shares.sum(axis=1, keepdims=True), 1e-30)


def join(first: SurfacePoints, second: SurfacePoints) -> SurfacePoints:
    """Points of both sets."""
    names = [f.name for f in fields(SurfacePoints)]
    return SurfacePoints(
        **{name: np.concatenate([getattr(first, name), getattr(second, name)]) for name in names}
    )


def merge(points: SurfacePoints, grid_mm: float) -> SurfacePoints:
    """One point per grid cell: the stiffness-weighted mean of those in it.

    A bond needs no more points than the grid has freedoms; fewer points cost less per substep.
    Vertices, drive and spring sideways of a merged point are those of its first member.
    """
    cell = np.round(points.position_mm / grid_mm).astype(np.int64)
    _, first, group = np.unique(cell, axis=0, return_index=True, return_inverse=True)
    stiffness = np.bincount(group.ravel(), points.stiffness_N_mm)
    weight = points.stiffness_N_mm[:, None]
    centre = _column_sums(group.ravel(), weight * points.position_mm, len(stiffness))
    axis = _column_sums(group.ravel(), weight * points.axis, len(stiffness))
    return SurfacePoints(
        position_mm=centre / stiffness[:, None],
        area_mm2=np.bincount(group.ravel(), points.area_mm2),
        stiffness_N_mm=stiffness,
        axis=_unit(axis),
        sideways=points.sideways[first],
        bonded=points.bonded[first],
        drive=points.drive[first],
        vertices=points.vertices[first],
        shares=points.shares[first],
    )


def _column_sums(group: np.ndarray, columns: np.ndarray, count: int) -> np.ndarray:
    """Sums of rows (N, C) by group (N,), shape (count, C)."""
    return np.stack([np.bincount(group, column, count) for column in columns.T], axis=1)


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-30)
