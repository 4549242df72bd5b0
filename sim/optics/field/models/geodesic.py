"""Shortest way on the skin: the paper's geodesic light field.

Where no way on the skin leads to the light, the straight line takes its place.
"""

from __future__ import annotations

import numpy as np

from sim.optics.field.directions import baked_directions
from sim.optics.field.model import Baked, Lights, Model, Shading
from sim.optics.light.geodesic import SkinWays
from workbench.core.base.monitor import Monitor


def bake(lights: Lights, monitor: Monitor) -> Baked:
    """First steps of the shortest ways; a DesignError on a skin that has none."""
    ways = SkinWays(lights.mesh.seen)

    def turn(straight: np.ndarray, place_mm: np.ndarray) -> np.ndarray:
        along = ways.toward(ways.nearest_vertex(place_mm))
        return np.where(np.isfinite(along), along, straight)

    return baked_directions(lights, monitor, turn)


MODEL = Model(
    place=4,
    hint="along the shortest way on the skin; the paper's geodesic field",
    shading=Shading.FIELD,
    bake=bake,
)
