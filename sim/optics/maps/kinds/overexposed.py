"""Skin that is too bright for the image sensor."""

from __future__ import annotations

import numpy as np

from sim.optics.maps.judging import mean_percent
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray:
    """1 where a colour is at its ceiling, NaN where no camera looks."""
    return np.where(scene.look.visible, scene.look.overexposed, np.nan)


MAP = MapKind(
    place=14,
    label="Overexposed",
    unit="1",
    meaning="1 where a colour of the image is at the sensor's ceiling, so that more light changes "
    "nothing there; the score is the share of seen skin.",
    measure=measure,
    more_is_better=False,
    score=mean_percent,
    figure="overexposed_percent",
    figure_label="skin overexposed",
    figure_unit="%",
    why="what is at the ceiling of a colour shows no touch in it",
    chief=True,
    yes_no=("overexposed", "within range"),
)
