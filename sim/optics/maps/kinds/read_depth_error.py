"""How far a depth read from one photograph is off by noise."""

from __future__ import annotations

import numpy as np

from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene
from sim.optics.maps.readability import depth_error_mm


def measure(scene: Scene) -> np.ndarray:
    """Standard deviation, by the noise of the design's camera."""
    return depth_error_mm(scene.mesh.seen, scene.look)


MAP = MapKind(
    place=10,
    label="Depth error",
    unit="mm",
    meaning="Standard deviation of a depth read from one photo of the sensor, by noise alone.",
    measure=measure,
    more_is_better=False,
    score=median,
    figure="depth_error_median_mm",
    figure_label="depth error of a reading",
    figure_unit="mm",
    why="the smaller it is, the nearer a depth read from a photograph is to the true one",
    chief=True,
)
