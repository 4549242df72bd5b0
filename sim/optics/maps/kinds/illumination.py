"""Light on the skin, scattered light included."""

from __future__ import annotations

import numpy as np

from sim.optics.field.model import model_of
from sim.optics.maps import lighting
from sim.optics.maps.judging import evenness
from sim.optics.maps.map_kind import MapKind, Scene


def measure(scene: Scene) -> np.ndarray | None:
    """Over its brightest percent; None of a light model without a physical scale."""
    if model_of(scene.light.model).paper:
        return None
    total = lighting.light_in_all(scene.light, -scene.mesh.seen.normals).mean(axis=1)
    return total / max(float(np.percentile(total, 99)), 1e-30)


MAP = MapKind(
    place=5,
    label="Light in all",
    unit="1",
    meaning="Light on the skin, scattered light included, over its brightest percent.",
    measure=measure,
    more_is_better=True,
    score=evenness,
    figure="light_evenness_p5_over_p95_1",
    figure_label="evenness of light",
    figure_unit="",
    why="even light uses the whole range of grey levels; 1 is perfectly even",
    chief=True,
)
