"""LEDs and their mirror images in front of the skin."""

from __future__ import annotations

import numpy as np

from sim.optics.field.model import model_of
from sim.optics.maps.judging import washed_out_percent
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray | None:
    """Over the skin's radiance; None of a light model without a physical scale."""
    return None if model_of(scene.light.model).paper else scene.look.glare


MAP = MapKind(
    place=13,
    label="Direct glare",
    unit="1",
    meaning="LEDs and their mirror images in front of the skin, over the skin's radiance; the "
    "score is the share of seen skin that an LED outshines.",
    measure=measure,
    more_is_better=False,
    score=washed_out_percent,
    figure="glare_percent",
    figure_label="glare",
    figure_unit="%",
    why="there an LED outshines the skin",
    chief=True,
)
