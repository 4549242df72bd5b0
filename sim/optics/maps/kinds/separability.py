"""How distinct the directions of the colours are."""

from __future__ import annotations

import numpy as np

from sim.optics.maps import lighting
from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray:
    """1 where three colours come from directions at right angles, 0 where from one."""
    return lighting.separability(scene.light)


MAP = MapKind(
    place=4,
    label="Separate colours",
    unit="1",
    meaning="1 where three colours come from directions at right angles, 0 where from one.",
    measure=measure,
    more_is_better=True,
    score=median,
    figure="led_separability_median_1",
    figure_label="separability of LEDs",
    figure_unit="",
    why="the direction that the maps of the skin declare (sim.optics.maps)",
)
