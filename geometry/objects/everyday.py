"""Everyday objects as closed meshes: a mug, a screwdriver and a banana, parametric in mm.

They stand in for the paper's YCB objects. Outer sizes: Calli and others, The YCB object and model
set, ICAR 2015, table of objects (mug 80 x 82 mm, Phillips screwdriver 31 x 215 mm, banana
36 x 190 mm); all other dimensions are ours. Each lies on its side with what a hand or a finger
meets toward -Z, and that place under the body origin.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from geometry.surface.primitives import rounded_revolution
from geometry.surface.surface import mesh_volume
from workbench.core.press.indenter import IndenterMesh

AROUND = 96
"""Facets around a body of revolution."""
RINGS = 64
"""Sections along a bent tube."""
MUG_MM = (80.0, 82.0)
"""Diameter and height."""
MUG_WALL_MM = 4.0
MUG_RIM_MM = 1.9
"""Rounding of the rim and of the edge of the bottom."""
HANDLE_MM = (26.0, 11.0)
"""Radius of the handle's bow and its thickness."""
SCREWDRIVER_MM = (31.0, 215.0)
"""Diameter of the grip and total length."""
GRIP_MM = 105.0
SHAFT_MM = 6.0
"""Diameter of the shaft; its tip narrows to a third."""
BANANA_MM = (36.0, 182.9)
"""Thickness in the middle, and distance of the ends of the middle line: 190 mm in all."""
BANANA_SAG_MM = 45.0
"""Height of the bow of the banana's middle line."""


def everyday(name: str) -> IndenterMesh:
    """An everyday object by its name in `EVERYDAY`."""
    points, faces = EVERYDAY[name]()
    if mesh_volume(points, faces) < 0.0:
        faces = faces[:, ::-1]
    return IndenterMesh(points_mm=points, faces=np.ascontiguousarray(faces, dtype=np.int32))


def _mug() -> tuple[np.ndarray, np.ndarray]:
    """A cup with a handle, lying: its wall toward -Z, its mouth toward +Y, its handle up."""
    import manifold3d

    diameter, height = MUG_MM
    outside = rounded_revolution(
        [(0.0, 0.0), (diameter / 2, 0.0), (diameter / 2, height), (0.0, height)], MUG_RIM_MM
    )
    inner = diameter / 2 - MUG_WALL_MM
    hollow = manifold3d.Manifold.cylinder(height, inner, inner, AROUND)
    bow, thick = HANDLE_MM
    ring = manifold3d.CrossSection.circle(thick / 2, AROUND // 2).translate((bow, 0.0))
    handle = manifold3d.Manifold.revolve(ring, AROUND).rotate((90.0, 0.0, 0.0))
    handle = handle.translate((diameter / 2 - 4.0, 0.0, height / 2))
    filled = _manifold(*outside) + handle
    cup = filled - hollow.translate((0.0, 0.0, MUG_WALL_MM))
    # From standing, handle along +X, to lying: x becomes z, z becomes y, y becomes x.
    points, faces = _arrays(cup)
    points = points[:, [1, 2, 0]]
    return points - [0.0, height / 2, 0.0], faces


def _screwdriver() -> tuple[np.ndarray, np.ndarray]:
    """Lying along Y with the middle of its grip under the origin; the shaft points to +Y."""
    width, length = SCREWDRIVER_MM
    grip = width / 2
    outline = [
        (0.0, -GRIP_MM / 2),
        (0.75 * grip, -GRIP_MM / 2),
        (grip, -0.3 * GRIP_MM),
        (grip, 0.3 * GRIP_MM),
        (0.55 * grip, GRIP_MM / 2),
        (SHAFT_MM / 2, GRIP_MM / 2 + 2.0),
        (SHAFT_MM / 2, length - GRIP_MM / 2 - 6.0),
        (SHAFT_MM / 6, length - GRIP_MM / 2),
        (0.0, length - GRIP_MM / 2),
    ]
    heights = np.array([z for _, z in outline])
    radii = np.array([r for r, _ in outline])
    centre = np.stack([np.zeros_like(heights), heights, np.zeros_like(heights)], axis=1)
    return _tube(centre[1:-1], radii[1:-1], np.zeros(len(heights) - 2))


def _banana() -> tuple[np.ndarray, np.ndarray]:
    """A bent tube along Y, its convex side toward -Z, thinner toward both ends."""
    thickness, length = BANANA_MM
    span = 0.5 * length
    radius = (span**2 + BANANA_SAG_MM**2) / (2.0 * BANANA_SAG_MM)
    widest = np.arcsin(span / radius)
    angle = np.linspace(-widest, widest, RINGS)
    zeros = np.zeros(RINGS)
    centre = np.stack([zeros, radius * np.sin(angle), radius * (1.0 - np.cos(angle))], axis=1)
    share = np.abs(angle) / widest
    # Nearly as thick along two thirds, then a neck of a quarter; the stem is not modelled.
    thick = 0.5 * thickness * np.sqrt(np.maximum(1.0 - share**3, 0.0625))
    points, faces = _tube(centre, thick, angle)
    # Processors differ in the last digit of sines and in the sign of a zero; keys must not.
    return points.round(6) + 0.0, faces


def _tube(
    centre: np.ndarray, radii: np.ndarray, angle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Round sections about points (S, 3) of a line in the YZ plane, closed at both ends.

    `angle` is the line's slope from +Y toward +Z [rad], shape (S,).
    """
    turn = 2.0 * np.pi * np.arange(AROUND) / AROUND
    upward = np.stack([np.zeros_like(angle), -np.sin(angle), np.cos(angle)], axis=1)
    aside = np.array([1.0, 0.0, 0.0])
    ring = np.cos(turn)[:, None] * aside + np.sin(turn)[:, None] * upward[:, None]
    points = centre[:, None] + radii[:, None, None] * ring
    number = np.arange(len(centre) * AROUND).reshape(len(centre), AROUND)
    low, up = number[:-1], number[1:]
    low_next, up_next = np.roll(low, -1, axis=1), np.roll(up, -1, axis=1)
    first, last = number.size, number.size + 1
    faces = [
        np.stack([low, up, up_next], axis=-1),
        np.stack([low, up_next, low_next], axis=-1),
        np.stack([number[0], np.roll(number[0], -1), np.full(AROUND, first)], axis=-1),
        np.stack([np.roll(number[-1], -1), number[-1], np.full(AROUND, last)], axis=-1),
    ]
    corners = np.vstack([points.reshape(-1, 3), centre[0], centre[-1]])
    return corners, np.concatenate([part.reshape(-1, 3) for part in faces])


def _manifold(points: np.ndarray, faces: np.ndarray) -> Any:
    import manifold3d

    mesh = manifold3d.Mesh64(
        vert_properties=np.ascontiguousarray(points, dtype=np.float64),
        tri_verts=np.ascontiguousarray(faces, dtype=np.uint64),
    )
    return manifold3d.Manifold(mesh)


def _arrays(solid: Any) -> tuple[np.ndarray, np.ndarray]:
    mesh = solid.to_mesh64()
    return np.array(mesh.vert_properties)[:, :3], np.array(mesh.tri_verts).astype(np.int64)


EVERYDAY: dict[str, Callable[[], tuple[np.ndarray, np.ndarray]]] = {
    "mug": _mug,
    "screwdriver": _screwdriver,
    "banana": _banana,
}
"""Objects by the name that the command line and the browser take."""
