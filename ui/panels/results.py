"""The right dock: tactile image, forces, maps, log; and the timeline through the frames."""

from __future__ import annotations

import html
from typing import Any

import viser

from ui.desk import Desk
from ui.imaging import legend
from ui.panels.forces import ForcesTab
from ui.panels.image import ImageTab
from ui.panels.maps import MapsPanel
from ui.player import SPEEDS, Player
from ui.sensor import SKIN_COLOUR
from workbench.core.errors import SolveError
from workbench.core.press import Press
from workbench.core.sensing import Contact, Shot
from workbench.glimpse import Glimpse
from workbench.live_press import Preview, live_press
from workbench.phases import phase
from workbench.quantities import Quantity

LOG_ROWS = 60
LIVE_NOTE = "**live**: one frame, not stored; *Run press* computes the path"
GLIMPSE_NOTE = "**preview**: {model} light, dent by geometry; *Run press* computes the image"


class ResultsPanel:
    """Widgets of the right dock and the timeline."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.contact: Contact | None = None
        self.press: Press = desk.session.case.press
        """The press that `contact` is of."""
        self.note = ""
        """What is said of frames that are not a whole press: a live one, or what settled."""
        self.sketch = ""
        """What is said of a picture that follows the sliders; empty while images are shown."""
        self.play_next = False
        """Whether the next images are played as soon as they are there."""
        self.stepping = False
        """Whether there are frames to step through."""
        self.covered = False
        """Whether parts or a mesh are looked at instead of the press."""
        gui = desk.server.gui
        self.dock = gui.add_panel()
        # Five labels without icons fit on one row.
        with self.dock.add_tab("Tactile image"):
            self.image = ImageTab(desk)
        with self.dock.add_tab("Forces"):
            self.forces = ForcesTab(gui)
        with self.dock.add_tab("Maps"):
            self.maps = MapsPanel(desk)
        with self.dock.add_tab("Log"):
            self.log = gui.add_html("")
        self.dock.dock_right()
        self.dock.set_width(350)
        self._timeline()

    def _timeline(self) -> None:
        gui = self.desk.server.gui
        self.timeline = panel = gui.add_panel(visible=False)
        with panel.add_tab("Timeline", viser.Icon.CLOCK):
            self.frame = gui.add_slider("Frame", 0, 1, 1, 0, hint="0 is the untouched skin")
            hint = "P or space; J and K go a frame back and on"
            self.play = gui.add_button("Play / pause", icon=viser.Icon.PLAYER_PLAY, hint=hint)
            self.legend = gui.add_html("")
            names = tuple(quantity.value for quantity in Quantity)
            hint = "The scale is that of all frames together"
            self.quantity = gui.add_dropdown("Colours", names, initial_value=names[0], hint=hint)
            hint = "Contact forces on the skin, a few added up in each arrow"
            self.arrows = gui.add_checkbox("Force arrows", False, hint=hint)
            hint = "Look at the skin below the object"
            self.bare = gui.add_checkbox("Hide object", False, hint=hint)
            with gui.add_folder("Pace", expand_by_default=False):
                hint = "1 × is twelve frames a second; frames that come too late are left out"
                speeds = tuple(SPEEDS)
                self.speed = gui.add_dropdown("Speed", speeds, initial_value=speeds[2], hint=hint)
                hint = "Begin again after the last frame; off, playing stops there"
                self.loop = gui.add_checkbox("Loop", False, hint=hint)
        panel.float(x=405, y=-15, width=380)
        self.frame.on_update(self.desk.guarded(lambda event: self._show_frame()))
        self.play.on_click(self.desk.guarded(self._toggle))
        self.quantity.on_update(self.desk.guarded(lambda event: self._paint()))
        self.arrows.on_update(self.desk.guarded(lambda event: self._draw_arrows()))
        self.bare.on_update(self.desk.guarded(lambda event: self._hide_object()))
        self.player = Player(self.frame)
        self.speed.on_update(self.desk.guarded(lambda event: self._pace()))
        self.loop.on_update(self.desk.guarded(lambda event: self._pace()))
        self._keys()

    def _keys(self) -> None:
        gui, guarded = self.desk.server.gui, self.desk.guarded
        for name, key, handler in (
            ("Play or pause", "P", self._toggle),
            ("Play or pause (space)", "space", self._toggle),
            ("Previous frame", "J", lambda event: self._step(-1)),
            ("Next frame", "K", lambda event: self._step(1)),
        ):
            gui.add_command(name, hotkey=key).on_trigger(guarded(handler))

    def _pace(self) -> None:
        self.player.speed = SPEEDS[self.speed.value]
        self.player.loop = bool(self.loop.value)

    def _step(self, frames: int) -> None:
        if self.timeline.visible:
            self.player.step(frames)

    def _paint(self) -> None:
        self.desk.scene.pressed.paint(Quantity(self.quantity.value))
        self.desk.scene.show_frame(int(self.frame.value))
        self._show_legend()

    def _show_legend(self) -> None:
        shown = self.desk.scene.pressed.shown
        if shown is not None:
            where = "zero everywhere" if shown.empty else "scale of all frames"
            title = f"{shown.quantity.value.capitalize()} of the skin, {where}"
            self.legend.content = legend(title, shown.top, shown.unit, SKIN_COLOUR)

    def _draw_arrows(self) -> None:
        wanted = bool(self.arrows.value)
        self.desk.scene.pressed.draw_arrows(wanted)
        # The arrows end below the object.
        self.desk.scene.see_through(wanted)

    def _hide_object(self) -> None:
        self.desk.scene.hide_indenter(bool(self.bare.value))

    def _toggle(self, event: Any) -> None:
        if self.player.playing:
            self.player.stop()
        elif self.timeline.visible:
            self.player.start()

    def _show_frame(self) -> None:
        number = int(self.frame.value)
        self.desk.scene.show_frame(number)
        self._show_image(number)
        self._show_forces(number)

    def _show_image(self, number: int) -> None:
        self._caption(number)
        self.image.show(number)

    def _caption(self, number: int) -> None:
        last = self.image.last
        if last is None:
            return
        what = "background"
        if number:
            what = f"frame {min(number, last)} of {last}, {self._phase(min(number, last))}"
        if self.sketch:
            self.image.say(self.sketch)
            return
        stale = "" if self.desk.current("shoot") else " · **stale**: render again"
        live = self.note == LIVE_NOTE
        self.image.say(f"live, {self._phase(number)}" if live else f"{what}{stale}")

    def _phase(self, number: int) -> str:
        """What happens in a frame; a live one is the last of its short path."""
        live = self.note == LIVE_NOTE and number > 0
        return phase(self.press, self.press.approach_frames if live else number)

    def refresh(self) -> None:
        """Mark an image and a force that no longer belong to the state."""
        live = self.desk.live.on
        self._caption(int(self.frame.value))
        self._show_forces(int(self.frame.value))
        if not live and not self.desk.current("press"):
            # There are no frames on the skin to step through.
            self.stepping = False
            self._offer_timeline()

    def show(self, stage: str, result: Any) -> None:
        """Follow results and the log."""
        if stage in ("build", "mesh"):
            self.image.probe.take_mesh(result if stage == "mesh" else None)
        elif stage == "press":
            self._show_contact(self.desk.session.case.press, result, note="")
        elif stage == "live":
            self._show_live(result)
        elif stage == "glimpse":
            self._show_glimpse(result)
        elif stage == "partial":
            self._show_partial(*result)
        elif stage == "shoot":
            self._show_shot(result)
        elif stage == "maps":
            self.image.measure()
        elif stage == "play":
            self.play_next = True
        elif stage == "run":
            self.player.stop()
        elif stage == "sensor":
            self._blank()
        elif stage == "covered":
            self.covered = result
            self._offer_timeline()
            if not self.covered:
                self.desk.scene.show_frame(int(self.frame.value))
        elif stage == "log":
            rows = "<br>".join(html.escape(line) for line in reversed(result[-LOG_ROWS:]))
            self.log.content = f"<div style='font:12px monospace;margin:8px'>{rows}</div>"

    def _show_shot(self, shot: Shot) -> None:
        self.sketch = ""
        self.image.load(shot)
        self.image.measure()
        self._follow_frames(self.image.last or 0)
        number = int(self.frame.value)
        self._show_image(number)
        self.desk.scene.show_frame(number)
        self.image.show_in_frusta(number)
        if self.play_next:
            self.play_next = False
            self.player.start()

    def _show_live(self, preview: Preview) -> None:
        """Show a live frame and its image; the scene has its skin already."""
        self.player.stop()
        self.sketch = ""
        self.contact, self.press = preview.contact, live_press(self.desk.session.case.press)
        self.note = LIVE_NOTE
        self.image.load_live(preview.images)
        self._show_legend()
        self._follow_frames(1)
        self._show_image(1)
        self.forces.load(self.press, preview.contact)
        self._show_forces(1)

    def _show_glimpse(self, glimpse: Glimpse) -> None:
        """Show the small picture of a state without images, in place of a stale one."""
        self.player.stop()
        self.sketch = GLIMPSE_NOTE.format(model=glimpse.model.value)
        self.image.load_live(glimpse.images)
        self._show_image(1)

    def _show_partial(self, contact: Contact, error: SolveError) -> None:
        """Show the frames that settled before a press failed."""
        self.image.forget()
        note = settled_note(error.frame, len(contact.reaction_N))
        self._show_contact(self.desk.session.case.press, contact, note=f"**{note}**")
        self.desk.log(note)

    def _follow_frames(self, count: int) -> None:
        if int(self.frame.max) != count:
            self.frame.value = min(int(self.frame.value), count)
            self.frame.max = count
        self.frame.value = count
        self.stepping = True
        self._offer_timeline()

    def _offer_timeline(self) -> None:
        visible = self.stepping and not self.covered
        if self.timeline.visible != visible:
            self.timeline.visible = visible

    def _blank(self) -> None:
        """What was seen and felt belongs to another sensor."""
        self.contact = None
        self.note = self.sketch = ""
        self.player.stop()
        with self.desk.server.atomic():
            self.image.clear()
            self.forces.clear()

    def _show_contact(self, press: Press, contact: Contact, *, note: str) -> None:
        mesh = self.desk.session.result("mesh")
        self.desk.scene.load_frames(mesh.outer, contact)
        self._show_legend()
        self.contact, self.press, self.note = contact, press, note
        self.forces.load(press, contact)
        self._follow_frames(len(contact.reaction_N))
        self._show_forces(int(self.frame.value))
        self.desk.scene.show_frame(int(self.frame.value))

    def _show_forces(self, number: int) -> None:
        """The force of the frame on show; of the last one at frame 0."""
        if self.contact is None:
            return
        count = len(self.contact.reaction_N)
        k = (number or count) - 1
        if k >= count:
            return
        note = self.note
        if not note and not self.desk.current("press"):
            note = "**stale**: run the press again"
        self.forces.mark(number)
        self.forces.show(self.contact, k, what=self._phase(k + 1), note=note)


def settled_note(failed: int, settled: int) -> str:
    """What is said of the frames that settled before frame `failed`, counted from 0, did not."""
    shown = f"frames 1..{settled} are shown" if settled > 1 else "frame 1 is shown"
    return f"frame {failed + 1} failed; {shown}"
