"""Length of skin that one pixel covers."""

from __future__ import annotations

import numpy as np

from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray:
    """Foreshortening included."""
    return scene.look.mm_per_pixel


MAP = MapKind(
    place=2,
    label="Skin per pixel",
    unit="mm",
    meaning="Length of skin that one pixel covers, foreshortening included.",
    measure=measure,
    more_is_better=False,
    score=median,
    figure="mm_per_pixel_median_mm",
    figure_label="skin per pixel",
    figure_unit="mm",
    why="the size of the smallest thing that two pixels can tell apart",
    chief=True,
)
