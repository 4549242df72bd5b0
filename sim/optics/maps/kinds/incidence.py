"""Angle between the skin and the line of sight."""

from __future__ import annotations

import numpy as np

from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray:
    """Of the refracted line of sight [degree]."""
    return scene.look.incidence_deg


MAP = MapKind(
    place=3,
    label="Angle of view",
    unit="deg",
    meaning="Between the skin's normal and the refracted line of sight; 90 is edge-on.",
    measure=measure,
    more_is_better=False,
    score=median,
    figure="incidence_median_deg",
    figure_label="angle of sight",
    figure_unit="°",
    why="the direction that the maps of the skin declare (sim.optics.maps)",
)
