"""The smallest dent that a reading of one photograph tells from none."""

from __future__ import annotations

import numpy as np

from sim.optics.maps.judging import median
from sim.optics.maps.map_kind import MapKind, Scene
from sim.optics.maps.readability import depth_error_mm, readable_dent_mm


def measure(scene: Scene) -> np.ndarray:
    """Depth of a ball of 6 mm."""
    return readable_dent_mm(scene.look, depth_error_mm(scene.mesh.seen, scene.look))


MAP = MapKind(
    place=11,
    label="Smallest readable dent",
    unit="mm",
    meaning="Least depth of a ball of 6 mm that a photo of the sensor tells from no touch.",
    measure=measure,
    more_is_better=False,
    score=median,
    figure="readable_dent_median_mm",
    figure_label="smallest readable dent",
    figure_unit="mm",
    why="a lighter touch is felt",
    chief=True,
)
