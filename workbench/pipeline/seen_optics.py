"""The optics that an image depends on, beside the light that was baked for it."""

from __future__ import annotations

import dataclasses

from sim.optics.field.model import model_of, quick_model
from sim.optics.studio.fitted_photos import fitted_photos
from workbench.core.design.lighting import Baking, LedRing
from workbench.core.design.optics import Optics


def seen_optics(optics: Optics) -> Optics:
    """The optics without what the baked light, or the object that is passed, says already."""
    optics = fitted_photos(dataclasses.replace(optics, detail=True))
    if model_of(optics.light_model).per_frame:
        return optics
    model = optics.light_model if model_of(optics.light_model).tabulated else quick_model()
    return dataclasses.replace(optics, ring=LedRing(), lamps=(), baking=Baking(), light_model=model)
