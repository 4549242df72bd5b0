"""Cheap shapes for the live view: the indenter, and where it would stand before a press."""

from __future__ import annotations

import numpy as np

from workbench.core.frames import quaternion, tangent
from workbench.core.press import Indenter
from workbench.core.results import Label, LabelledSurface


def indenter_shape(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
    """Vertices [mm] (N, 3) in the body frame and triangles (M, 3) of an indenter."""
    from geometry.indenters import display_mesh

    return display_mesh(indenter)


def outer_faces(surface: LabelledSurface) -> tuple[np.ndarray, np.ndarray]:
    """The sensing side of a body: its vertices [mm] (N, 3) and triangles (M, 3)."""
    faces = surface.faces[(surface.labels & Label.OUTER) != 0]
    used, packed = np.unique(faces, return_inverse=True)
    return np.asarray(surface.points_mm)[used], packed.reshape(faces.shape)


def corner_normals(points_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Area-weighted unit normals at the vertices, shape (N, 3)."""
    a, b, c = (points_mm[faces[:, i]] for i in range(3))
    normals = np.zeros_like(points_mm)
    for i in range(3):
        np.add.at(normals, faces[:, i], np.cross(b - a, c - a))
    return normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)


def standing_pose(
    points_mm: np.ndarray,
    normals: np.ndarray,
    target_mm: tuple[float, float, float],
    lowest_mm: float,
) -> np.ndarray:
    """x, y, z [mm], qw, qx, qy, qz of an indenter that stands on the skin near the target.

    For the eye only: the solver finds first touch exactly.

    Args:
        lowest_mm: Extent of the indenter below its body origin.
    """
    nearest = int(np.argmin(((points_mm - np.asarray(target_mm)) ** 2).sum(axis=1)))
    normal = normals[nearest]
    tangent_u = tangent(normal)
    rotation = np.stack([tangent_u, np.cross(normal, tangent_u), normal], axis=1)
    return np.r_[points_mm[nearest] + normal * lowest_mm, quaternion(rotation)]
