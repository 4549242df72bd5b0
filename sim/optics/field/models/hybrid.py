"""Traced light and shadows: unscattered photons as one virtual LED each, a table of the rest."""

from __future__ import annotations

from sim.optics.field.gathered import gathered
from sim.optics.field.model import Model, Shading

MODEL = Model(
    place=7,
    hint="traced photons, with the soft shadow of each LED; the best quick images",
    shading=Shading.HYBRID,
    bake=gathered,
)
