"""Which parts of the sensor the designer sees, and how opaque: kept when the body is rebuilt."""

from __future__ import annotations

import enum

from ui.scene.object_view import PRESSING
from ui.scene.scene import Scene
from ui.scene.sensor import PINS, SKIN, SUPPORT


class Seen(enum.StrEnum):
    """What can be shown or hidden by itself; names for people."""

    SKIN = "Skin"
    SUPPORT = "Support"
    FOOT = "Foot"
    PINS = "Pins"
    LEDS = "LEDs"
    CAMERAS = "Cameras"
    OBJECT = "Object"


OPACITY: dict[Seen, float] = {
    Seen.SKIN: SKIN["opacity"],
    Seen.SUPPORT: SUPPORT["opacity"],
    Seen.FOOT: 1.0,
    Seen.PINS: float(PINS.get("opacity", 1.0)),
    Seen.LEDS: 1.0,
    Seen.OBJECT: PRESSING,
}
"""Opacity at first; viser draws the outlines of cameras, which have none."""


class Look:
    """Shows, hides and fades parts of one scene."""

    def __init__(self, scene: Scene) -> None:
        self.scene = scene
        self._groups = {
            Seen.SKIN: scene.body.skin,
            Seen.SUPPORT: scene.body.support,
            Seen.FOOT: scene.body.foot,
            Seen.PINS: scene.body.inside,
        }

    def show(self, what: Seen, wanted: bool) -> None:
        """Let a part be seen, or hide it."""
        scene = self.scene
        with scene.server.atomic():
            if what is Seen.OBJECT:
                scene.object.allow(wanted)
            elif what is Seen.LEDS:
                scene.rig.allow(lights=wanted, cameras=scene.rig.cameras_allowed)
            elif what is Seen.CAMERAS:
                scene.rig.allow(lights=scene.rig.lights_allowed, cameras=wanted)
            else:
                self._groups[what].allow(wanted)
            if what is Seen.SKIN:
                scene.pressed.allow(wanted)
            if what is Seen.PINS:
                scene.body.follow_tips()
            scene.section.follow()

    def fade(self, what: Seen, opacity: float) -> None:
        """Draw a part with an opacity in [0, 1]."""
        scene = self.scene
        with scene.server.atomic():
            if what is Seen.OBJECT:
                scene.object.fade(opacity)
            elif what is Seen.LEDS:
                scene.rig.leds.fade(opacity)
            elif what in self._groups:
                self._groups[what].set_opacity(opacity)
