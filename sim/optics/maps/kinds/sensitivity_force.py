"""Change of the image for a force of 0.1 N."""

from __future__ import annotations

import numpy as np

from sim.optics.maps import signal
from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene
from sim.optics.maps.wall import wall_mm


def measure(scene: Scene) -> np.ndarray | None:
    """Grey levels under a ball of 6 mm; None of a skin with a gap behind it."""
    mesh, look = scene.mesh, scene.look
    if mesh.backing_mm or len(mesh.tips_mm):
        return None
    depth_mm = signal.depth_at_force_mm(signal.FORCE_N, scene.young_MPa, wall_mm(mesh))
    change = signal.sensitivity_grey(look.jacobian, signal.dent_slope_deg(depth_mm))
    return np.where(look.visible, change, np.nan)


MAP = MapKind(
    place=9,
    label="Sensitivity to force",
    unit="grey/0.1 N",
    meaning="Mean change under a ball of 6 mm pressed with 0.1 N, on the wall's thickness.",
    measure=measure,
    more_is_better=True,
    score=median,
    figure="sensitivity_median_grey_per_0.1N",
    figure_label="sensitivity to force",
    figure_unit="grey/0.1 N",
    why="more grey levels for the same touch stand out more from noise",
    chief=True,
)
