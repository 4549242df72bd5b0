"""Bodies with closed forms, as raw triangles, and lights: what checks of traced light work on."""

from __future__ import annotations

import math

import numpy as np

from sim.optics.light.lights import Leds
from sim.optics.transport.sources import Sources
from workbench.core.design.optics import Coating
from workbench.core.result.results import Skin

BLACK = Coating(albedo=0.0, specular=0.0)
"""Takes all light at its first hit."""


def sphere(radius_mm: float, halvings: int) -> Skin:
    """A closed sphere: an octahedron whose triangles are divided in four `halvings` times."""
    points = np.vstack([np.eye(3), -np.eye(3)])
    faces = np.array(
        [[0, 1, 2], [1, 3, 2], [3, 4, 2], [4, 0, 2], [1, 0, 5], [3, 1, 5], [4, 3, 5], [0, 4, 5]]
    )
    for _ in range(halvings):
        edges = np.sort(faces[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
        unique, number = np.unique(edges, axis=0, return_inverse=True)
        middle = number.reshape(-1, 3) + len(points)
        points = np.vstack([points, points[unique].mean(axis=1)])
        a, b, c = faces.T
        ab, bc, ca = middle.T
        parts = [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        faces = np.concatenate([np.column_stack(part) for part in parts])
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    return Skin(points_mm=radius_mm * normals, faces=faces.astype(np.int32), normals=normals)


def plane(height_mm: float, half_side_mm: float, cells: int) -> Skin:
    """A square facing up at a height, in `cells` x `cells` squares of two triangles."""
    ticks = np.linspace(-half_side_mm, half_side_mm, cells + 1)
    x, y = np.meshgrid(ticks, ticks, indexing="ij")
    points = np.column_stack([x.ravel(), y.ravel(), np.full(x.size, height_mm)])
    number = np.arange(x.size).reshape(x.shape)
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    faces = np.vstack([np.column_stack([a, b, c]), np.column_stack([a, c, d])])
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    return Skin(points_mm=points, faces=faces.astype(np.int32), normals=normals)


def disc(height_mm: float, radius_mm: float, sectors: int = 720) -> Skin:
    """A disc facing up at a height; 720 sectors lack 1.3e-5 of its area."""
    around = 2.0 * np.pi * np.arange(sectors) / sectors
    rim = radius_mm * np.column_stack([np.cos(around), np.sin(around), np.zeros(sectors)])
    points = np.vstack([rim, np.zeros((1, 3))])
    points[:, 2] = height_mm
    here = np.arange(sectors)
    faces = np.column_stack([here, (here + 1) % sectors, np.full(sectors, sectors)])
    normals = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    return Skin(points_mm=points, faces=faces.astype(np.int32), normals=normals)


def one_light(
    *,
    position_mm: tuple[float, float, float] = (0.0, 0.0, 0.0),
    axis: tuple[float, float, float] = (0.0, 0.0, 1.0),
    exponent: float = 1.0,
    cone: float = 0.0,
    size_mm: float = 0.0,
    in_shell: bool = False,
) -> Leds:
    """One white light of power 1."""
    return Leds(
        position_mm=np.array([position_mm]),
        axis=np.array([axis]) / np.linalg.norm(axis),
        rgb=np.ones((1, 3)),
        exponent=np.array([exponent]),
        cone=np.array([cone]),
        size_mm=np.array([size_mm]),
        in_shell=np.array([in_shell]),
    )


def beam(angle_deg: float) -> Leds:
    """A beam half a degree wide, at an angle to +Z."""
    tilt = math.radians(angle_deg)
    axis = (math.sin(tilt), 0.0, math.cos(tilt))
    return one_light(axis=axis, exponent=0.0, cone=math.cos(math.radians(0.25)))


def disc_source(radius_mm: float) -> Sources:
    """A Lambertian disc of any size; `open_sources` would keep it clear of surfaces."""
    return Sources(
        position_mm=np.zeros((1, 3), dtype=np.float32),
        axis=np.array([[0.0, 0.0, 1.0]], dtype=np.float32),
        emission=np.array([[1.0, 0.0, radius_mm]], dtype=np.float32),
        in_shell=np.zeros(1, dtype=np.int32),
        power=np.ones((1, 3), dtype=np.float32),
        strongest=1.0,
    )
