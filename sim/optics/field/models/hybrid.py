"""Unscattered photons as one virtual LED each, with shadows, and a table of the rest."""

from __future__ import annotations

from sim.optics.field.gathered import gathered
from sim.optics.field.model import Model, Shading

MODEL = Model(
    place=7,
    title="traced light and shadows",
    hint="traced photons, with the soft shadow of each LED; the best quick images",
    shading=Shading.HYBRID,
    bake=gathered,
)
