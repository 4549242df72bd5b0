"""Further lights: ambient light, and points, lines and areas, one of which is edited at a time."""

from __future__ import annotations

from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.callbacks import put
from ui.panels.optics.handles import Handle
from workbench.core.design.lighting import Lamp, LampKind, LedMount
from workbench.edit.item_fields import without_item
from workbench.edit.light_edit import colour_words, new_lamp, read_colour
from workbench.system.names import NONE
from workbench.view.choice_words import named, words

LAMP_KINDS = named(LampKind)
"""Lamps by what designers read."""
LAMPS, AMBIENT = "design.optics.lamps", "design.optics.ambient"


class LampsFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        gui = desk.server.gui
        self.number = 1
        """Of the lamp that is edited, from 1."""
        self.edited = ""
        """Path of the lamp that the widgets edit; "" without any."""
        with gui.add_folder("Further lights", expand_by_default=False):
            self.add = gui.add_button_group(
                "Add lamp",
                tuple(LAMP_KINDS),
                hint="A point, a line or an area of light, beside the ring",
            )
            self.add.on_click(desk.guarded(self._add))
            self.choice = gui.add_dropdown(
                "Lamp", (NONE,), visible=False, hint="The lamp that is edited below"
            )
            self.choice.on_update(desk.guarded(self._choose))
            desk.fields.anchor("Lamps", LAMPS)
            self.handle = Handle(desk, "Lamp handle", path=lambda: self.edited)
            self.body = gui.add_folder(None, visible=False)
            self.drop = gui.add_button(
                "Remove lamp",
                icon=viser.Icon.TRASH,
                visible=False,
                hint="Takes the lamp that is edited; Undo brings it back",
            )
            self.drop.on_click(desk.guarded(self._remove))
            self._ambient()

    def _ambient(self) -> None:
        fields = self.desk.fields
        hint = "That falls on the whole skin evenly from all sides, in units of a ring LED's"
        fields.slider("Ambient power", f"{AMBIENT}.power", span=(0.0, 20.0, 0.05), hint=hint)
        fields.text(
            "Ambient colour",
            f"{AMBIENT}.colour",
            read=lambda text: read_colour(text, at="optics.ambient.colour"),
            write=lambda colour: colour_words((colour,)),
            hint="red, #ff0000, 525nm, 525nm/35nm or 5600K",
        )

    @property
    def lamps(self) -> tuple[Lamp, ...]:
        """The design's lamps."""
        return self.desk.session.design.optics.lamps

    def _add(self, event: Any) -> None:
        lamp = new_lamp(LAMP_KINDS[event.target.value], self.desk.session.design.optics.ring)
        self.number = len(self.lamps) + 1
        self._put((*self.lamps, lamp))

    def _remove(self, event: Any) -> None:
        self._put(without_item(self.lamps, self.number))

    def _put(self, lamps: tuple[Lamp, ...]) -> None:
        self.desk.edit(LAMPS, lamps)
        self.refresh()

    def _choose(self, event: Any) -> None:
        if event.client is not None and self.choice.value != NONE:
            self.number = self.choice.options.index(self.choice.value) + 1
            self.refresh()

    def refresh(self) -> None:
        """List the lamps as they stand, and edit the chosen one."""
        lamps = self.lamps
        self.number = max(1, min(self.number, len(lamps)))
        names = tuple(f"lamp {k}: {words(lamp.kind)}" for k, lamp in enumerate(lamps, 1)) or (NONE,)
        if tuple(self.choice.options) != names:
            self.choice.options = names
        put(self.choice, names[self.number - 1])
        for handle in (self.choice, self.body, self.drop):
            if handle.visible != bool(lamps):
                handle.visible = bool(lamps)
        self._follow(f"{LAMPS}[{self.number}]" if lamps else "")
        self.handle.follow()
        if lamps:
            self._fit(lamps[self.number - 1].kind)

    def _follow(self, path: str) -> None:
        """Let the widgets edit the lamp of this path."""
        fields = self.desk.fields
        if path and self.edited:
            fields.rebind(self.edited, path)
        elif path:
            with self.body:
                self._widgets(path)
        elif self.edited:
            fields.forget(self.edited)
        self.edited = path

    def _widgets(self, path: str) -> None:
        fields = self.desk.fields
        hint = "Its middle, sensor frame: z counts from the base"
        fields.point("Lamp mm", f"{path}.position_mm", step=0.5, hint=hint)
        hint = "Direction that it shines in, of any length; 0, 0, 1 is up"
        fields.point("Shines along", f"{path}.axis", step=0.1, hint=hint)
        hint = "Direction of its length, across the way it shines"
        fields.point("Lies along", f"{path}.along", step=0.1, hint=hint)
        fields.slider(
            "Length mm",
            f"{path}.length_mm",
            span=(0.1, 40.0, 0.1),
            hint="Of the line or area that shines",
        )
        fields.slider(
            "Width mm", f"{path}.width_mm", span=(0.1, 40.0, 0.1), hint="Of the area that shines"
        )
        hint = "Points of light that it is divided into, about"
        fields.slider("Samples", f"{path}.samples", span=(1, 64, 1), whole=True, hint=hint)
        fields.slider(
            "Disc mm",
            f"{path}.size_mm",
            span=(0.1, 5.0, 0.05),
            hint="Diameter of the point that shines; for traced light and glare",
        )
        fields.text(
            "Lamp colour",
            f"{path}.colour",
            read=lambda text: read_colour(text, at=f"{self.edited.split('.', 1)[1]}.colour"),
            write=lambda colour: colour_words((colour,)),
            hint="red, #ff0000, 525nm, 525nm/35nm or 5600K",
        )
        hint = "Of the whole lamp, in units of a ring LED's"
        fields.slider("Lamp power", f"{path}.power", span=(0.0, 20.0, 0.1), hint=hint)
        fields.slider(
            "Cone deg",
            f"{path}.cone_deg",
            span=(1.0, 180.0, 1.0),
            hint="Full angle that it shines into; 180 is the half space",
        )
        fields.choice(
            "Sits in",
            f"{path}.mount",
            list(LedMount),
            hint="What surrounds the lamp",
        )
        fields.anchor("Lamp", path)

    def _fit(self, kind: LampKind) -> None:
        """Show what lamps of this form have."""
        reveal, path = self.desk.fields.reveal, self.edited
        for name in ("along", "length_mm", "samples"):
            reveal(f"{path}.{name}", kind is not LampKind.POINT)
        reveal(f"{path}.width_mm", kind is LampKind.AREA)
        reveal(f"{path}.size_mm", kind is LampKind.POINT)
