"""The timeline: a low bar below the sensor that steps through and plays the frames of a press.

The skin's looks and the pace have tabs of their own: the bar must not hide what it plays.
"""

from __future__ import annotations

from collections.abc import Callable

from ui.desk.desk import Desk
from ui.page.imaging import legend
from ui.page.player import SPEEDS, Player
from ui.scene.sensor import SKIN_COLOUR
from workbench.core.result.force_field import Source
from workbench.view.force_sources import source_of
from workbench.view.quantities import Quantity

BACK, PLAY, ON = "◀ Back", "Play / pause", "On ▶"
SKIN = {
    Source.MPM: "of the skin",
    Source.FEM: "by finite elements",
    Source.LEARNED: "by the network",
}
"""Whose the skin on show is."""
UNKNOWN = "not given by this source"
DOUBT = "doubtful"
"""A badge for forces of a network that does not know the press; the panel says what."""
WIDTH_PX, NARROW_PX = 515, 300
"""What is left between the docks on a page of 1280 pixels, less its margins; and beside a large
image."""


class Timeline:
    """Widgets of the bar."""

    def __init__(self, desk: Desk, on_frame: Callable[[int], None]) -> None:
        self.desk = desk
        self.on_frame = on_frame
        """Told which frame is on show, counted from 1; 0 is the untouched skin."""
        self.stepping = False
        """Whether there are frames to step through."""
        self.covered = False
        """Whether parts or a mesh are looked at instead of the press."""
        gui, guarded = desk.server.gui, desk.guarded
        self.panel = gui.add_panel(visible=False)
        with self.panel.add_tab("Timeline"):
            self.legend = gui.add_html("")
            self.frame = gui.add_slider("Frame", 0, 1, 1, 0, hint="0 is the untouched skin")
            hint = "P or space plays; J and K go a frame back and on"
            self.steps = gui.add_button_group("Step", (BACK, PLAY, ON), hint=hint)
        with self.panel.add_tab("Skin"):
            self._looks()
        with self.panel.add_tab("Pace"):
            self._pace()
        self.panel.float(x=15, y=-15, width=WIDTH_PX)
        self.panel.expand()
        self.player = Player(self.frame)
        self.frame.on_update(guarded(lambda event: self.on_frame(self.number)))
        self.steps.on_click(guarded(lambda event: self._stepped()))
        desk.scene.on_painted = self.show_legend
        self._keys()

    @property
    def number(self) -> int:
        """The frame on show."""
        return int(self.frame.value)

    def narrow(self, narrow: bool) -> None:
        """Take less room, or all that there is between the docks."""
        self.panel.set_width(NARROW_PX if narrow else WIDTH_PX)

    def _looks(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        names = tuple(quantity.value for quantity in Quantity)
        hint = "The scale is that of all frames together"
        self.quantity = gui.add_dropdown("Colours", names, initial_value=names[0], hint=hint)
        hint = "Contact forces on the skin, a few added up in each arrow"
        self.arrows = gui.add_checkbox("Force arrows", False, hint=hint)
        hint = "Look at the skin below the object"
        self.bare = gui.add_checkbox("Hide object", False, hint=hint)
        self.quantity.on_update(guarded(lambda event: self._paint()))
        self.arrows.on_update(guarded(lambda event: self._draw_arrows()))
        self.bare.on_update(guarded(lambda event: self._hide_object()))

    def _pace(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        hint = "1 × is twelve frames a second; frames that come too late are left out"
        speeds = tuple(SPEEDS)
        self.speed = gui.add_dropdown("Speed", speeds, initial_value=speeds[2], hint=hint)
        hint = "Begin again after the last frame; off, playing stops there"
        self.loop = gui.add_checkbox("Loop", False, hint=hint)
        self.speed.on_update(guarded(lambda event: self._set_pace()))
        self.loop.on_update(guarded(lambda event: self._set_pace()))

    def _keys(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        for name, key, handler in (
            ("Play or pause", "P", self._toggle),
            ("Play or pause (space)", "space", self._toggle),
            ("Previous frame", "J", lambda: self._step(-1)),
            ("Next frame", "K", lambda: self._step(1)),
        ):
            command = gui.add_command(name, hotkey=key)
            command.on_trigger(guarded(lambda event, act=handler: act()))

    def _stepped(self) -> None:
        if self.steps.value == PLAY:
            self._toggle()
        else:
            self._step(-1 if self.steps.value == BACK else 1)

    def _set_pace(self) -> None:
        self.player.speed = SPEEDS[self.speed.value]
        self.player.loop = bool(self.loop.value)

    def _step(self, frames: int) -> None:
        if self.panel.visible:
            self.player.step(frames)

    def _toggle(self) -> None:
        if self.player.playing:
            self.player.stop()
        elif self.panel.visible:
            self.player.start()

    def _paint(self) -> None:
        self.desk.scene.pressed.paint(Quantity(self.quantity.value))

    def show_legend(self) -> None:
        """Show the scale of the colours on the skin."""
        pressed = self.desk.scene.pressed
        shown = pressed.shown
        if shown is not None:
            where = "zero everywhere" if shown.empty else "scale of all frames"
            whose = SKIN[source_of(pressed.field)]
            what = "difference of two sources" if shown.difference else whose
            what, where = (what, where) if shown.known else ("of the skin", UNKNOWN)
            title = f"{shown.quantity.value.capitalize()} {what}, {where}"
            doubt = DOUBT if getattr(pressed.field, "notice", "") else ""
            self.legend.content = legend(title, shown.top, shown.unit, SKIN_COLOUR, badge=doubt)

    def _draw_arrows(self) -> None:
        wanted = bool(self.arrows.value)
        self.desk.scene.pressed.draw_arrows(wanted)
        # The arrows end below the object.
        self.desk.scene.object.see_through(wanted)

    def _hide_object(self) -> None:
        self.desk.scene.object.hide(bool(self.bare.value))

    def offer(self, *, stepping: bool | None = None, covered: bool | None = None) -> None:
        """Show the bar while there are frames and nothing else is looked at."""
        self.stepping = self.stepping if stepping is None else stepping
        self.covered = self.covered if covered is None else covered
        visible = self.stepping and not self.covered
        if self.panel.visible != visible:
            self.panel.visible = visible

    def follow(self, count: int) -> None:
        """Step through so many frames from now on; the last one is on show."""
        if int(self.frame.max) != count:
            self.frame.value = min(self.number, count)
            self.frame.max = count
        self.frame.value = count
        self.offer(stepping=True)
