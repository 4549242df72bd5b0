"""Optics: baking the light of the default finger and rendering one frame."""

from __future__ import annotations

import numpy as np

from workbench.benchmarks.timing import finger_mesh, median_s, timed_row
from workbench.core.design import LightModel, Optics
from workbench.core.monitor import silent
from workbench.rows import Row, bounded
from workbench.stages import bake

FRAMES = 6
PRESS_MM = 1.0
RADIUS_MM = 3.0


def dent(points_mm: np.ndarray, normals: np.ndarray) -> np.ndarray:
    """A smooth dent of 1 mm near (0, 10, 35), so that this room needs no contact."""
    nearest = points_mm[np.argmin(((points_mm - [0.0, 10.0, 35.0]) ** 2).sum(axis=1))]
    square = ((points_mm - nearest) ** 2).sum(axis=1)
    moved = -PRESS_MM * np.exp(-square / (2 * RADIUS_MM**2))[:, None] * normals
    moved[square > (3 * RADIUS_MM) ** 2] = 0.0
    return moved.astype(np.float32)


def rows() -> list[Row]:
    """All rows of the room."""
    from sim.optics.render import shoot

    mesh, optics = finger_mesh(), Optics()
    light = bake(mesh, optics.ring, optics.light_model, monitor=silent)
    one = dent(mesh.outer.points_mm, mesh.outer.normals)
    many = np.stack([one] * (1 + FRAMES))
    first_s = median_s(lambda: shoot(mesh, light, optics, displacement_mm=many[:1]))
    all_s = median_s(lambda: shoot(mesh, light, optics, displacement_mm=many), runs=3)
    case = f"640x480, {len(mesh.outer.faces)} triangles"
    found = [
        timed_row(
            "bake", model.value, lambda m=model: bake(mesh, optics.ring, m, monitor=silent), 5.0
        )
        for model in LightModel
    ]
    found.append(bounded("image", case, (all_s - first_s) / FRAMES, unit="s", limit=0.2))
    found.append(bounded("first_image", f"{case}, camera just moved", first_s, unit="s", limit=3.0))
    return found
