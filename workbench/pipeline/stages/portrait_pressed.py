"""The stage `portrait_pressed`: thumbnails of the skin in the last frame of a press."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.results import MembraneMesh, Picture
from workbench.core.result.sensing import Contact
from workbench.pipeline.stage import Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class PressedThumbnailInputs:
    """What is drawn."""

    mesh: MembraneMesh
    contact: Contact


def pressed_thumbnail(given: PressedThumbnailInputs, *, monitor: Monitor) -> Picture:
    """The drawing; a DeviceError where nothing can render."""
    from geometry.drawing.thumbnails import pressed

    contact = given.contact
    return Picture(png=pressed(given.mesh.outer, contact.displacement_mm[-1], contact.normal))


STAGE = Stage(
    # Thumbnails lie in stores and in keys under this name.
    name="portrait_pressed",
    label="Thumbnail of the press",
    version=1,
    place=22,
    lane="cad",
    run=pressed_thumbnail,
    shown=False,
)
