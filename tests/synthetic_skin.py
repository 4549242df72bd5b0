"""Condensed skins without finite elements: a compliance that falls with distance, with coupling."""

from __future__ import annotations

import numpy as np

from workbench.core.result.condensed import CondensedSkin, SkinColumns

REACH_MM, FALL_MM = 4.0, 0.9
ACROSS = 1.6
"""Compliance across the normal over that along it [1]."""
COUPLING = 0.25
WALL_MM = 2.0


def soft_skin(points_mm: np.ndarray, normals: np.ndarray, faces: np.ndarray) -> CondensedSkin:
    """A skin of 1 mm/N at each node; a push moves what is beside it outwards."""
    from scipy.spatial import KDTree

    pairs = KDTree(points_mm).query_pairs(REACH_MM, output_type="ndarray")
    own = np.arange(len(points_mm))
    rows = np.concatenate([pairs[:, 0], pairs[:, 1], own])
    columns = np.concatenate([pairs[:, 1], pairs[:, 0], own])
    order = np.lexsort((columns, rows))
    rows, columns = rows[order], columns[order]
    apart = points_mm[rows] - points_mm[columns]
    fall = np.exp(-np.square(np.linalg.norm(apart, axis=1) / FALL_MM))
    moved, pushed = normals[rows], normals[columns]
    blocks = ACROSS * np.eye(3) + (1.0 - ACROSS) * moved[:, :, None] * pushed[:, None, :]
    # What is pulled aside sinks by as much: the compliance stays symmetric.
    blocks = blocks - COUPLING * apart[:, :, None] * pushed[:, None, :]
    blocks = blocks + COUPLING * moved[:, :, None] * apart[:, None, :]
    return CondensedSkin(
        points_mm=points_mm,
        normals=normals,
        wall_mm=np.full(len(points_mm), WALL_MM),
        faces=faces.astype(np.int32),
        reach_mm=REACH_MM,
        compliance=SkinColumns(
            nodes=own.astype(np.int32),
            starts=np.searchsorted(rows, np.arange(len(own) + 1)).astype(np.int64),
            neighbours=columns.astype(np.int32),
            blocks_mm_N=(fall[:, None, None] * blocks).astype(np.float32),
        ),
    )


def flat_skin(edge: int, spacing_mm: float) -> CondensedSkin:
    """A square of so many nodes along each edge, about the origin, facing +Z."""
    line = (np.arange(edge) - edge // 2) * spacing_mm
    x, y = np.meshgrid(line, line, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.zeros(edge**2)])
    at = np.arange(edge**2).reshape(edge, edge)
    a, b, c, d = (part.ravel() for part in (at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]))
    faces = np.concatenate([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    return soft_skin(points, np.tile([0.0, 0.0, 1.0], (len(points), 1)), faces)
