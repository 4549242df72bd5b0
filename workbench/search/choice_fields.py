"""Fields of a design that are one of a few words: what a search may choose among beside numbers."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.design.camera import LensModel
from workbench.core.design.lighting import LedMount


@dataclass(frozen=True, slots=True)
class ChoiceField:
    """A field with all that it may be."""

    path: str
    """Dotted field of the state."""
    values: tuple[str, ...]


CHOICES = {
    "LED ring: mount": ChoiceField("design.optics.ring.mount", tuple(LedMount)),
    "Camera: lens": ChoiceField("design.optics.camera.lens", tuple(LensModel)),
}
"""By what people read. Lenses with coefficients of their own stand for those of the design."""
