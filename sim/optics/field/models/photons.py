"""Traced anew each frame: photons for all of them, the slow reference."""

from __future__ import annotations

import dataclasses

import numpy as np

from sim.optics.field.directions import baked_directions
from sim.optics.field.model import Baked, Lights, Model, Shading
from workbench.core.base.monitor import Monitor


def bake(lights: Lights, monitor: Monitor) -> Baked:
    """Straight lines without light: nothing is baked."""
    lines = baked_directions(lights, monitor)
    return dataclasses.replace(lines, irradiance=np.zeros_like(lines.irradiance))


MODEL = Model(
    place=8,
    hint="photons traced anew for every frame; slow, the reference",
    shading=Shading.GIVEN,
    bake=bake,
)
