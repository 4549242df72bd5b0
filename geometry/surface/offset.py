"""The surface at an even depth below a skin: marching cubes through the distance to it.

The skin is all of a closed body but its face on z = 0. Below z = 0 the skin is thought to go on
straight down, so that the offset meets the base at right angles; the caller cuts it there.
Distances are exact where the surface will pass and estimated elsewhere.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.isosurface import distance_mm, isosurface
from geometry.surface.rays import RayCaster
from geometry.surface.surface import on_plane

STEPS = 5.0
"""Grid cells through the offset."""
FINEST_MM, COARSEST_MM = 0.25, 0.5
COARSE = 4
"""Steps between the places that are measured first."""
LIFT_MM = 1e-4
"""Height at which places below the base are looked at."""


def inset_surface(
    points_mm: np.ndarray, faces: np.ndarray, inset_mm: float
) -> tuple[tuple[np.ndarray, np.ndarray] | None, float]:
    """Closed surface at a depth below the skin of a body that stands on z = 0.

    Returns:
        Vertices (N, 3) and triangles (M, 3), or None if the body is not so deep; and the largest
        depth [mm] as far as it was looked for.
    """
    step = float(np.clip(inset_mm / STEPS, FINEST_MM, COARSEST_MM))
    low, high = points_mm.min(axis=0), points_mm.max(axis=0)
    axes = [np.arange(a - step, b + 2 * step, step) for a, b in zip(low, high, strict=True)]
    axes[2] = np.arange(-2.5 * step, high[2] + 2 * step, step)
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    grid[..., 2] = np.maximum(grid[..., 2], LIFT_MM)
    depth = _depth(points_mm, faces, grid, inset_mm, step)
    deepest_mm = float(depth.max())
    if deepest_mm < inset_mm + step / 2:
        return None, deepest_mm
    values = inset_mm - depth
    # The lowest layer closes the surface; the cut at z = 0 takes that lid away.
    values[:, :, 0] = step
    return isosurface(values, [float(axis[0]) for axis in axes], step), deepest_mm


def inside(points_mm: np.ndarray, faces: np.ndarray, places_mm: np.ndarray) -> np.ndarray:
    """Whether places lie inside a closed surface, shape (N,): the first face above looks up."""
    # Off +Z, because a ray along an upright wall would graze edges and vertices.
    upward = np.array([0.0131, 0.0217, 1.0])
    directions = np.broadcast_to(upward, places_mm.shape)
    _, face, _ = RayCaster(points_mm, faces).hits(places_mm, directions)
    corners = points_mm[faces[face]]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ upward
    return (face >= 0) & (facing > 0.0)


def _depth(
    points_mm: np.ndarray, faces: np.ndarray, grid: np.ndarray, inset_mm: float, step: float
) -> np.ndarray:
    """Depth of a grid (X, Y, Z, 3) below the skin [mm], (X, Y, Z); -step outside.

    Every fourth place is measured first. A distance changes by no more than the way gone, so only
    places whose nearest measured one is within that of the inset need be measured themselves.
    """
    skin = faces[~on_plane(points_mm, faces)]
    coarse = grid[::COARSE, ::COARSE, ::COARSE]
    known = distance_mm(points_mm, skin, coarse.reshape(-1, 3)).reshape(coarse.shape[:3])
    index = np.meshgrid(
        *[
            np.minimum((np.arange(size) + COARSE // 2) // COARSE, have - 1)
            for size, have in zip(grid.shape[:3], known.shape, strict=True)
        ],
        indexing="ij",
    )
    estimate = known[tuple(index)].ravel()
    places = grid.reshape(-1, 3)
    away = np.linalg.norm(places - coarse[tuple(index)].reshape(-1, 3), axis=1)
    near = np.flatnonzero(np.abs(estimate - inset_mm) < away + 2 * step)
    estimate[near] = distance_mm(points_mm, skin, places[near])
    deep = inside(points_mm, faces, places)
    return np.where(deep, estimate, -step).reshape(grid.shape[:3])
