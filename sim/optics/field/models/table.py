"""Traced light, quickest: photons gathered for every tilt of the skin's normal."""

from __future__ import annotations

from sim.optics.field.gathered import gathered
from sim.optics.field.model import Model, Shading

MODEL = Model(
    place=6,
    hint="traced photons in a table over the skin's tilt; quickest images",
    shading=Shading.TABLE,
    bake=gathered,
)
