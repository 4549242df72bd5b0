"""How far a force of 0.1 N that is read from one photograph is off by noise."""

from __future__ import annotations

import numpy as np

from sim.optics.maps import signal
from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene
from sim.optics.maps.readability import depth_error_mm
from sim.optics.maps.wall import wall_mm

STEEP = 1.5
"""Relative change of the force over that of the depth, of a ball on a thick wall: F ~ d^1.5."""


def measure(scene: Scene) -> np.ndarray | None:
    """Standard deviation under a ball of 6 mm; None of a skin with a gap behind it."""
    mesh, look = scene.mesh, scene.look
    if mesh.backing_mm or len(mesh.tips_mm):
        return None
    depth_mm = signal.depth_at_force_mm(signal.FORCE_N, scene.young_MPa, wall_mm(mesh))
    return 100.0 * STEEP * depth_error_mm(mesh.seen, look) / np.maximum(depth_mm, 1e-6)


MAP = MapKind(
    place=12,
    label="Force error",
    unit="%",
    meaning="Standard deviation of a force of 0.1 N under a ball of 6 mm, read from one photo, by "
    "noise alone; the law of the wall adds its own 15 %.",
    measure=measure,
    more_is_better=False,
    score=median,
    figure="force_error_median_percent",
    figure_label="force error of a reading",
    figure_unit="%",
    why="the smaller it is, the nearer a force read from a photograph is to the true one",
    chief=True,
)
