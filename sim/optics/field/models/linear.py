"""Straight rays: the paper's linear light field."""

from __future__ import annotations

from sim.optics.field.directions import baked_directions
from sim.optics.field.model import Baked, Lights, Model, Shading
from workbench.core.base.monitor import Monitor


def bake(lights: Lights, monitor: Monitor) -> Baked:
    """Directions to the light."""
    return baked_directions(lights, monitor)


MODEL = Model(
    place=0,
    hint="straight rays of even strength; the paper's linear field",
    shading=Shading.FIELD,
    bake=bake,
    quick=True,
    straight=True,
)
