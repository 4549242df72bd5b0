"""Change of the image for a dent of 0.1 mm."""

from __future__ import annotations

import numpy as np

from sim.optics.maps import signal
from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray:
    """Grey levels under a ball of 6 mm."""
    slope_deg = signal.dent_slope_deg(signal.DENT_MM)
    change = signal.sensitivity_grey(scene.look.jacobian, slope_deg)
    return np.where(scene.look.visible, change, np.nan)


MAP = MapKind(
    place=8,
    label="Sensitivity to depth",
    unit="grey/0.1 mm",
    meaning="Mean change under a ball of 6 mm pressed 0.1 mm deep.",
    measure=measure,
    more_is_better=True,
    score=median,
    figure="sensitivity_median_grey_per_0.1mm",
    figure_label="sensitivity to depth",
    figure_unit="grey/0.1 mm",
    why="more grey levels for the same touch stand out more from noise",
    chief=True,
)
