"""Unscattered light of every LED and lamp by itself: a map for each."""

from __future__ import annotations

import numpy as np

from sim.optics.field.model import model_of
from sim.optics.maps import lighting
from sim.optics.maps.judging import reached_percent
from sim.optics.maps.map_kind import LightMaps, MapKind, Scene

PLACE = 6


def measure(scene: Scene) -> list[tuple[MapKind, str, np.ndarray]]:
    """Over the brightest of all; none of a light model without a physical scale."""
    if model_of(scene.light.model).paper:
        return []
    each = lighting.light_of_each(scene.light, -scene.mesh.seen.normals)
    scale = max(float(np.percentile(each, 99.5)), 1e-30)
    return [
        (_kind(number), f"led_{number:02d}", row / scale)
        for number, row in enumerate(each, start=1)
    ]


def _kind(number: int) -> MapKind:
    return MapKind(
        place=PLACE,
        label=f"Light of LED {number}",
        unit="1",
        meaning="Unscattered light of this LED over the brightest of all; its score is the "
        "share of skin with a tenth of that or more.",
        measure=lambda scene: None,
        more_is_better=True,
        score=reached_percent,
        figure=f"led_{number:02d}_reach_percent",
        figure_label=f"reach of LED {number}",
        figure_unit="%",
        why="each LED should light the skin that its colour tells of",
    )


MAPS = LightMaps(place=PLACE, measure=measure)
