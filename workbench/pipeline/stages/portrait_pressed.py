"""The stage `portrait_pressed`: the skin in the last frame of a press, small, for lists."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.results import MembraneMesh, Picture
from workbench.core.result.sensing import Contact
from workbench.pipeline.stage import Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class PortraitPressedInputs:
    """What is drawn."""

    mesh: MembraneMesh
    contact: Contact


def portrait_pressed(given: PortraitPressedInputs, *, monitor: Monitor) -> Picture:
    """The drawing; a DeviceError where nothing can render."""
    from geometry.picture.portraits import pressed

    contact = given.contact
    return Picture(png=pressed(given.mesh.outer, contact.displacement_mm[-1], contact.normal))


STAGE = Stage(
    name="portrait_pressed",
    label="Thumbnail of the press",
    version=1,
    place=22,
    lane="cad",
    run=portrait_pressed,
    shown=False,
)
