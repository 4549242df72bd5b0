"""Optics: baking the light of the default finger and rendering one frame."""

from __future__ import annotations

import functools

import numpy as np

from workbench.benchmarks.timing import RUNS, median_s, timed_row
from workbench.core.light import LightField
from workbench.core.lighting import LightModel
from workbench.core.monitor import silent
from workbench.core.optics import Optics
from workbench.rows import Row, bounded
from workbench.specimens import finger_mesh
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

    optics = Optics()
    found = [
        timed_row(
            "bake",
            model.value,
            lambda model=model: bake(finger_mesh(), optics.ring, (), model, monitor=silent),
            5.0,
        )
        for model in LightModel
    ]

    @functools.cache
    def light() -> LightField:
        return bake(finger_mesh(), optics.ring, (), optics.light_model, monitor=silent)

    def seconds(frames: int, runs: int) -> float:
        outer = finger_mesh().outer
        moved = np.stack([dent(outer.points_mm, outer.normals)] * frames)
        view = functools.partial(shoot, finger_mesh(), light(), optics, displacement_mm=moved)
        return median_s(view, runs=runs)

    first_s = functools.cache(lambda: seconds(1, RUNS))
    case = "640x480, 0.4 mm triangles"
    return [
        *found,
        bounded(
            "image",
            case,
            lambda: (seconds(1 + FRAMES, 3) - first_s()) / FRAMES,
            unit="s",
            limit=0.2,
        ),
        bounded("first_image", f"{case}, camera just moved", first_s, unit="s", limit=3.0),
    ]
