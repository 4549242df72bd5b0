"""What photons meet: the coated skin and the clear wall of the cavity, as one set of triangles.

The cavity holds air, index 1. Between its wall and the skin everything is one clear solid of index
n: support and elastomer have nearly the same index, so their bond neither bends nor reflects. Both
surfaces are open at the base plane, which absorbs; the skin is opaque. No triangle lies below that
plane, so what goes down and meets nothing has left through it.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.surface import vertex_normals
from workbench.core.base.check import expect
from workbench.core.design.optics import Coating, Transport
from workbench.core.result.results import MembraneMesh


@dataclass(frozen=True, kw_only=True, slots=True)
class Scene:
    """Triangles of the skin first, then those of the wall."""

    points_mm: np.ndarray
    """Vertices [mm], those of the skin first, shape (P, 3), float32."""
    normals: np.ndarray
    """Unit vertex normals out of the sensor, shape (P, 3), float32."""
    faces: np.ndarray
    """Triangles, counter-clockwise seen from outside, shape (F, 3), int32."""
    skin_points: int
    """Vertices of the skin."""
    skin_faces: int
    """Triangles of the skin."""
    coating: Coating
    refractive_index: float
    """Of the solid between wall and skin [1]."""


def open_scene(
    mesh: MembraneMesh, transport: Transport, *, displacement_mm: np.ndarray | None = None
) -> Scene:
    """The scene of a membrane at rest, or with its seen skin moved.

    Args:
        mesh: The skins.
        transport: Coating and refractive index.
        displacement_mm: Of the seen skin's vertices [mm], shape (V, 3); its normals follow.
    """
    skin, wall = mesh.seen, mesh.cavity
    points, normals = skin.points_mm, skin.normals
    if displacement_mm is not None:
        expect(displacement_mm, f"{len(points)} 3", name="displacement")
        points = points + displacement_mm
        normals = vertex_normals(points, skin.faces)
    return build_scene(
        (points, normals, skin.faces),
        (wall.points_mm, wall.normals, wall.faces),
        coating=transport.coating,
        refractive_index=transport.refractive_index,
    )


def build_scene(
    skin: tuple[np.ndarray, np.ndarray, np.ndarray],
    wall: tuple[np.ndarray, np.ndarray, np.ndarray] | None,
    *,
    coating: Coating,
    refractive_index: float = 1.0,
) -> Scene:
    """A scene of raw triangles: points (N, 3), unit normals (N, 3) and faces (M, 3) of each.

    Args:
        skin: The coated surface.
        wall: The wall of the cavity; None where there is none.
        coating: Of the skin.
        refractive_index: Of the solid between them.
    """
    nothing = np.zeros((0, 3)), np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int32)
    points, normals, faces = wall or nothing
    together = np.vstack([skin[0], points])
    return Scene(
        points_mm=together.astype(np.float32),
        normals=np.vstack([skin[1], normals]).astype(np.float32),
        faces=np.vstack([skin[2], faces + len(skin[0])]).astype(np.int32),
        skin_points=len(skin[0]),
        skin_faces=len(skin[2]),
        coating=coating,
        refractive_index=refractive_index,
    )
