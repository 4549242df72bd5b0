"""Baking of models that give each light a direction at each vertex, of even strength."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim.optics.field.lines import toward
from sim.optics.field.model import Baked, Lights
from workbench.core.base.monitor import Monitor

Turn = Callable[[np.ndarray, np.ndarray], np.ndarray]
"""Of the straight directions (V, 3) and a place of light [mm] (3,): the directions (V, 3)."""


def baked_directions(lights: Lights, monitor: Monitor, turn: Turn | None = None) -> Baked:
    """Straight lines from each vertex to each light, turned by the model."""
    skin, leds = lights.mesh.seen, lights.leds
    count = len(leds.position_mm)
    direction = np.empty((count, len(skin.points_mm), 3), dtype=np.float32)
    for number, place in enumerate(leds.position_mm):
        monitor(number / count, f"light {number + 1} of {count}")
        straight, _ = toward(place, skin.points_mm, at=lights.fields[number])
        direction[number] = straight if turn is None else turn(straight, place)
    return Baked(direction=direction, irradiance=np.ones(direction.shape[:2], dtype=np.float32))
