"""Exact specimens for validation: a flat block and a finger, made in numpy without a CAD kernel.

Skins are regular grids on the exact surfaces.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.contact.region.filling import fill
from sim.specimens import finger_skin, skins_only
from workbench.core.result.results import MaterialPoints, MembraneMesh, Skin

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
    axes = [np.linspace(-s, s, count + 1) for s, count in zip(half, counts, strict=True)]
    u, v = np.meshgrid(*axes, indexing="ij")
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
    shift_mm: tuple[float, float, float] = (0.0, 0.0, 0.0),
) -> Specimen:
    """A cylinder with a hemispherical tip, its base at z = 0, bonded on the inside.

    It may be shifted against the lattice.
    """

    def radial(x: np.ndarray) -> np.ndarray:
        over = np.maximum(x[..., 2] - cylinder_mm, 0.0)
        return np.sqrt(x[..., 0] ** 2 + x[..., 1] ** 2 + over**2)

    def distance(place: np.ndarray) -> np.ndarray:
        x = place - np.array(shift_mm)
        wall = np.abs(radial(x) - (radius_mm - 0.5 * wall_mm)) - 0.5 * wall_mm
        return np.maximum(wall, -x[..., 2])

    low = np.array([-radius_mm, -radius_mm, 0.0]) + shift_mm
    high = np.array([radius_mm, radius_mm, cylinder_mm + radius_mm]) + shift_mm
    outer, inner = (
        dataclasses.replace(skin, points_mm=skin.points_mm + np.array(shift_mm))
        for skin in (
            finger_skin(radius_mm, cylinder_mm, skin_mm),
            finger_skin(radius_mm - wall_mm, cylinder_mm, skin_mm),
        )
    )
    return skins_only(outer=outer, inner=inner, cavity=inner), fill(distance, low, high, grid_mm)


def grid_faces(rows: int, columns: int) -> np.ndarray:
    """Triangles of a (rows + 1) x (columns + 1) vertex grid."""
    i, j = np.meshgrid(np.arange(rows), np.arange(columns), indexing="ij")
    a = i * (columns + 1) + j
    b, d = a + columns + 1, a + 1
    c = b + 1
    return np.concatenate(
        [np.stack([a, b, c], axis=-1).reshape(-1, 3), np.stack([a, c, d], axis=-1).reshape(-1, 3)]
    ).astype(np.int32)
