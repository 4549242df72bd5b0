"""Exact specimens for validation: a flat block and a finger, made in numpy without a CAD kernel.

Fractions come from 4x4x4 samples of each sub-cell that the surface may cut. Skins are regular
grids on the exact surfaces.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim.specimens import finger_skin, skins_only
from workbench.core.results import MaterialPoints, MembraneMesh, Skin

SAMPLES = 4
"""Samples per axis of a sub-cell."""

Distance = Callable[[np.ndarray], np.ndarray]
Specimen = tuple[MembraneMesh, MaterialPoints]


def flat_block(
    *,
    width_mm: float,
    height_mm: float,
    grid_mm: float,
    skin_mm: float = 0.4,
    length_mm: float | None = None,
) -> Specimen:
    """A block bonded at z = 0 with its free face at z = height; square unless `length_mm`, along
    y, is given."""
    half = 0.5 * np.array([width_mm, length_mm or width_mm])

    def distance(x: np.ndarray) -> np.ndarray:
        lateral = np.maximum(np.abs(x[..., 0]) - half[0], np.abs(x[..., 1]) - half[1])
        return np.maximum(lateral, np.maximum(x[..., 2] - height_mm, -x[..., 2]))

    low, high = np.array([*-half, 0.0]), np.array([*half, height_mm])
    counts = [max(1, round(2.0 * side / skin_mm)) for side in half]
    sides = [np.linspace(-s, s, count + 1) for s, count in zip(half, counts, strict=True)]
    u, v = np.meshgrid(*sides, indexing="ij")
    faces = grid_faces(*counts)
    up = np.tile([0.0, 0.0, 1.0], (u.size, 1))
    top = np.stack([u.ravel(), v.ravel(), np.full(u.size, height_mm)], axis=1)
    outer = Skin(points_mm=top, faces=faces, normals=up)
    inner = Skin(points_mm=top * [1.0, 1.0, 0.0], faces=faces, normals=up)
    return skins_only(outer=outer, inner=inner, cavity=inner), fill(distance, low, high, grid_mm)


def finger(
    *,
    radius_mm: float = 15.0,
    wall_mm: float = 2.0,
    cylinder_mm: float = 27.0,
    grid_mm: float = 0.5,
    skin_mm: float = 0.4,
) -> Specimen:
    """A cylinder with a hemispherical tip, its base at z = 0, bonded on the inside."""

    def radial(x: np.ndarray) -> np.ndarray:
        over = np.maximum(x[..., 2] - cylinder_mm, 0.0)
        return np.sqrt(x[..., 0] ** 2 + x[..., 1] ** 2 + over**2)

    def distance(x: np.ndarray) -> np.ndarray:
        wall = np.abs(radial(x) - (radius_mm - 0.5 * wall_mm)) - 0.5 * wall_mm
        return np.maximum(wall, -x[..., 2])

    low = np.array([-radius_mm, -radius_mm, 0.0])
    high = np.array([radius_mm, radius_mm, cylinder_mm + radius_mm])
    outer = finger_skin(radius_mm, cylinder_mm, skin_mm)
    inner = finger_skin(radius_mm - wall_mm, cylinder_mm, skin_mm)
    return skins_only(outer=outer, inner=inner, cavity=inner), fill(distance, low, high, grid_mm)


def fill(distance: Distance, low: np.ndarray, high: np.ndarray, grid_mm: float) -> MaterialPoints:
    """Material points of the solid where a distance-like function is negative.

    Args:
        distance: Positions (..., 3) to values; its slope is at most 1.
        low: Lower corner of the solid's box [mm], shape (3,).
        high: Upper corner.
        grid_mm: Cell edge.
    """
    first = np.floor(low / grid_mm).astype(int) - 1
    last = np.ceil(high / grid_mm).astype(int) + 1
    axes = [np.arange(a, b + 1) for a, b in zip(first, last, strict=True)]
    cells = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = cells[distance(cells * grid_mm) < 0.87 * grid_mm]
    bits = np.stack(np.meshgrid(*[[-0.25, 0.25]] * 3, indexing="ij"), axis=-1).reshape(8, 3)
    centres = (cells[:, None] + bits) * grid_mm
    value = distance(centres)
    fractions = (value < 0).astype(np.float32)
    cut = np.abs(value) < 0.45 * grid_mm
    step = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
    offsets = np.stack(np.meshgrid(*[step] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
    samples = centres[cut][:, None] + 0.5 * grid_mm * offsets
    fractions[cut] = (distance(samples) < 0).mean(axis=1)
    held = fractions.any(axis=1)
    return MaterialPoints(
        grid_mm=grid_mm, cells=cells[held].astype(np.int32), fractions=fractions[held]
    )


def grid_faces(rows: int, columns: int) -> np.ndarray:
    """Triangles of a (rows + 1) x (columns + 1) vertex grid."""
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a = i * (columns + 1) + j
    b, d = a + columns + 1, a + 1
    c = b + 1
    return np.concatenate(
        [np.stack([a, b, c], axis=-1).reshape(-1, 3), np.stack([a, c, d], axis=-1).reshape(-1, 3)]
    ).astype(np.int32)
