"""Points that carry surface forces: contact on the outer skin, bonding on the inner skin.

Each triangle is divided until its pieces are no longer than a cell; each piece is one point at its
centroid with the piece's area. A point's spring is penalty * E / grid per area.
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
    bonded: np.ndarray
    """True: held at its place (inner skin). False: may meet the indenter. Shape (P,), bool."""
    face: np.ndarray
    """Triangle of its own skin, shape (P,), int64."""

    def take(self, chosen: np.ndarray) -> SurfacePoints:
        """The chosen points, by index or mask."""
        return SurfacePoints(
            position_mm=self.position_mm[chosen],
            stiffness_N_mm=self.stiffness_N_mm[chosen],
            bonded=self.bonded[chosen],
            face=self.face[chosen],
        )


def skin_points(
    skin: Skin, *, stiffness_N_mm3: float, spacing_mm: float, bonded: bool, faces: np.ndarray
) -> SurfacePoints:
    """Points on some triangles of a skin.

    Args:
        skin: The surface.
        stiffness_N_mm3: Spring per area.
        spacing_mm: Longest edge of a piece.
        bonded: Whether the points are held.
        faces: Triangles to use, by index.
    """
    corners = skin.points_mm[skin.faces[faces]]
    edges = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    divisions = np.maximum(1, np.ceil(edges / spacing_mm - 1e-9)).astype(int)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = 0.5 * np.linalg.norm(normal, axis=1)
    positions, areas, owners = [], [], []
    for count in np.unique(divisions):
        chosen = np.flatnonzero(divisions == count)
        shares = piece_centroids(int(count))
        positions.append(np.einsum("sk,fkc->fsc", shares, corners[chosen]).reshape(-1, 3))
        areas.append(np.repeat(area[chosen] / count**2, count**2))
        owners.append(np.repeat(faces[chosen], count**2))
    stiffness = stiffness_N_mm3 * np.concatenate(areas) if areas else np.empty(0)
    return SurfacePoints(
        position_mm=np.concatenate(positions) if positions else np.empty((0, 3)),
        stiffness_N_mm=stiffness,
        bonded=np.full(len(stiffness), bonded),
        face=np.concatenate(owners) if owners else np.empty(0, dtype=np.int64),
    )


def piece_centroids(count: int) -> np.ndarray:
    """Barycentric centroids of a triangle cut into count^2 equal pieces, shape (count^2, 3)."""
    up = [(i + 1 / 3, j + 1 / 3) for i in range(count) for j in range(count - i)]
    down = [(i + 2 / 3, j + 2 / 3) for i in range(count - 1) for j in range(count - 1 - i)]
    first, second = np.array(up + down).T / count
    return np.stack([1.0 - first - second, first, second], axis=1)


def join(first: SurfacePoints, second: SurfacePoints) -> SurfacePoints:
    """Points of both sets."""
    return SurfacePoints(
        position_mm=np.concatenate([first.position_mm, second.position_mm]),
        stiffness_N_mm=np.concatenate([first.stiffness_N_mm, second.stiffness_N_mm]),
        bonded=np.concatenate([first.bonded, second.bonded]),
        face=np.concatenate([first.face, second.face]),
    )


def merge(points: SurfacePoints, grid_mm: float) -> SurfacePoints:
    """One point per grid cell: the stiffness-weighted mean of those in it.

    A bond needs no more points than the grid has freedoms; fewer points cost less per substep.
    The face of a merged point is that of its first member.
    """
    cell = np.round(points.position_mm / grid_mm).astype(np.int64)
    _, first, group = np.unique(cell, axis=0, return_index=True, return_inverse=True)
    stiffness = np.bincount(group.ravel(), points.stiffness_N_mm)
    moment = points.stiffness_N_mm[:, None] * points.position_mm
    centre = np.stack([np.bincount(group.ravel(), moment[:, c]) for c in range(3)], axis=1)
    return SurfacePoints(
        position_mm=centre / stiffness[:, None],
        stiffness_N_mm=stiffness,
        bonded=points.bonded[first],
        face=points.face[first],
    )
