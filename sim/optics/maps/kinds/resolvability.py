"""The least tilt that pixel noise lets through."""

from __future__ import annotations

import numpy as np

from sim.optics.maps import signal
from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray:
    """Standard deviations of noise for one degree."""
    look = scene.look
    return np.where(look.visible, signal.resolvability(look.jacobian, look.noise), np.nan)


MAP = MapKind(
    place=7,
    label="Normal resolvability",
    unit="1/deg",
    meaning="Standard deviations of pixel noise for one degree of tilt, in the direction "
    "that shows least.",
    measure=measure,
    more_is_better=True,
    score=median,
    figure="normal_resolvability_median_per_deg",
    figure_label="resolvability of normals",
    figure_unit="1/°",
    why="the direction that the maps of the skin declare (sim.optics.maps)",
    chief=True,
)
