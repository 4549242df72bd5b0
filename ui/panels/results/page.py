"""The right dock: tactile image, forces, maps, log; it follows results and the timeline."""

from __future__ import annotations

import html
from typing import Any

import numpy as np

from ui.desk.desk import Desk
from ui.panels.page import Page
from ui.panels.results.forces import ForcesTab
from ui.panels.results.image import ImageTab
from ui.panels.results.maps import MapsPanel
from ui.panels.results.sources import STAGES, SourcesFolder
from ui.panels.results.timeline import Timeline
from ui.patches.image_zoom import TAB
from workbench.core.base.errors import SolveError
from workbench.core.press.press import Press
from workbench.core.result.sensing import Contact, Shot
from workbench.live.image_preview import ImagePreview
from workbench.live.live_press import PressPreview, live_press
from workbench.view.frame_words import phase
from workbench.view.wall_under import wall_under_mm

LOG_ROWS = 60
LIVE_NOTE = "**live**: one frame, not stored; *Run press* computes the path"
PREVIEW_NOTE = "**preview**: {model} light, dent by geometry; *Update results* computes the image"
BEFORE_NOTE = "**outdated preview, of the shape before**: the new shape is being built"
EARLIER_NOTE = "**preview of an earlier design**: this one cannot be previewed, see the log"


class ResultsPanel:
    """Widgets of the right dock and the timeline."""

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.contact: Contact | None = None
        self.press: Press = desk.session.case.press
        """The press that `contact` is of."""
        self.key = ""
        """Key of that press; empty for a live one."""
        self.note = ""
        """What is said of frames that are not a whole press: a live one, or what settled."""
        self.preview_note = ""
        """What is said of an image preview; empty while images are shown."""
        self.current_note = ""
        """The same of a preview that has the shape of the state."""
        self.play_next = False
        """Whether the next images are played as soon as they are there."""
        gui = desk.server.gui
        self.dock = gui.add_panel()
        # Five labels without icons fit on one row.
        with self.dock.add_tab(TAB):
            self.image = ImageTab(desk, self.dock)
        with self.dock.add_tab("Forces"):
            self.forces = ForcesTab(desk)
            self.sources = SourcesFolder(desk)
        with self.dock.add_tab("Maps"):
            self.maps = MapsPanel(desk)
        with self.dock.add_tab("Log"):
            self.log = gui.add_html("")
        self.dock.dock_right()
        # On a narrow page docks are sections of one sheet, closed unless told otherwise.
        self.dock.expand()
        self.timeline = Timeline(desk, self._show_frame)
        self.image.size.sized.connect(self.timeline.narrow)

    def _show_frame(self, number: int) -> None:
        # Or the page draws the view once for the skin and once for the image.
        with self.desk.server.atomic():
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
        if self.preview_note:
            self.image.say(self.preview_note)
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
        live = self.desk.live
        self._caption(self.timeline.number)
        self.sources.network.refresh()
        self._show_forces(self.timeline.number)
        if not live and not self.desk.current("press"):
            # There are no frames on the skin to step through.
            self.timeline.offer(stepping=False)

    def show(self, stage: str, result: Any) -> None:
        """Follow results and the log."""
        if stage in ("build", "mesh"):
            self.image.probe.take_mesh(result if stage == "mesh" else None)
        elif stage == "press":
            self._show_contact(self.desk.session.case.press, result, note="")
            self.sources.network.follow()
        elif stage in STAGES:
            self.sources.take(stage, result)
        elif stage == "live":
            self._show_live(result)
        elif stage == "image_preview":
            self._show_image_preview(result)
        elif stage == "image_preview_of_shape":
            self._date_preview(of_now=result)
        elif stage == "partial":
            self._show_partial(*result)
        elif stage == "shoot":
            self._show_shot(result)
            self.sources.network.follow()
        elif stage == "maps":
            self.image.measure()
        elif stage == "play":
            self.play_next = True
        elif stage == "run":
            self.timeline.player.stop()
            self.sources.network.give_way()
        elif stage == "sensor":
            self._blank()
        elif stage == "covered":
            self.timeline.offer(covered=result)
            if not result:
                self.desk.scene.show_frame(self.timeline.number)
        elif stage == "log":
            rows = "<br>".join(html.escape(line) for line in reversed(result[-LOG_ROWS:]))
            self.log.content = f"<div style='font:12px monospace;margin:8px'>{rows}</div>"

    def _show_shot(self, shot: Shot) -> None:
        self.preview_note = ""
        self.image.load(shot)
        self.image.measure()
        self.timeline.follow(self.image.last or 0)
        number = self.timeline.number
        self._show_image(number)
        self.desk.scene.show_frame(number)
        self.image.show_in_frusta(number)
        if self.play_next:
            self.play_next = False
            self.timeline.player.start()

    def _show_live(self, preview: PressPreview) -> None:
        """Show a live frame and its image; the scene has its skin already."""
        self.timeline.player.stop()
        self.preview_note = ""
        self.contact, self.press = preview.contact, live_press(self.desk.session.case.press)
        self.note, self.key = LIVE_NOTE, ""
        self.image.load_live(preview.images)
        self.timeline.show_legend()
        self.timeline.follow(1)
        self._show_image(1)
        wall_mm = self._wall_mm(self.press, preview.contact)
        self.forces.load(self.press, preview.contact, wall_mm=wall_mm)
        self.sources.take_contact(None)
        self._show_forces(1)

    def _show_image_preview(self, preview: ImagePreview | None) -> None:
        """Show the image preview of a state without images, in place of a stale one.

        None is that of a state for which there is none: what is on show is an earlier one's.
        """
        if preview is None:
            self.preview_note = self.preview_note and EARLIER_NOTE
            self._caption(self.timeline.number)
            return
        self.timeline.player.stop()
        self.preview_note = self.current_note = PREVIEW_NOTE.format(model=preview.model.value)
        self.image.load_live(preview.images)
        self._show_image(1)

    def _date_preview(self, *, of_now: bool) -> None:
        """Say of the preview on show, if there is one, whether it has the shape of the state."""
        if self.preview_note:
            self.preview_note = self.current_note if of_now else BEFORE_NOTE
            self._caption(self.timeline.number)

    def _show_partial(self, contact: Contact, error: SolveError) -> None:
        """Show the frames that settled before a press failed."""
        self.image.forget()
        note = settled_note(error.frame, len(contact.reaction_N))
        self._show_contact(self.desk.session.case.press, contact, note=f"**{note}**")
        self.desk.log(note)

    def _blank(self) -> None:
        """What was seen and felt belongs to another sensor."""
        self.contact = None
        self.note = self.preview_note = ""
        self.timeline.player.stop()
        with self.desk.server.atomic():
            self.image.clear()
            self.forces.clear()
            self.sources.take_contact(None)

    def _show_contact(self, press: Press, contact: Contact, *, note: str) -> None:
        mesh = self.desk.session.result("mesh")
        self.desk.scene.load_frames(mesh.outer, contact)
        self.contact, self.press, self.note = contact, press, note
        self.key = self.desk.session.calls()["press"].key
        self.forces.load(press, contact, wall_mm=self._wall_mm(press, contact))
        self.sources.take_contact(contact, mesh.outer)
        self.timeline.follow(len(contact.reaction_N))
        self._show_forces(self.timeline.number)
        self.desk.scene.show_frame(self.timeline.number)

    def _wall_mm(self, press: Press, contact: Contact) -> float | None:
        """Elastomer over the support where the press goes in; None where that is not known."""
        solid = self.desk.scene.body.solid
        if solid is None or press.trajectory is not None:
            return None
        return wall_under_mm(solid, np.asarray(contact.target_mm), np.asarray(contact.normal))

    @property
    def _of_now(self) -> bool:
        """Whether the press on show, whole or as far as it settled, is that of the state."""
        return self.key == self.desk.session.calls()["press"].key

    def _show_forces(self, number: int) -> None:
        """The force of the frame on show; of the last one at frame 0."""
        if self.contact is None:
            return
        count = len(self.contact.reaction_N)
        k = (number or count) - 1
        if k >= count:
            return
        note = self.note
        followed = note == LIVE_NOTE and self.desk.live
        if not followed and not self._of_now:
            note = "**stale**: run the press again"
        self.forces.mark(number)
        self.forces.show(self.contact, k, what=self._phase(k + 1), note=note)
        self.sources.tell(k)


def settled_note(failed: int, settled: int) -> str:
    """What is said of the frames that settled before frame `failed`, counted from 0, did not."""
    shown = f"frames 1..{settled} are shown" if settled > 1 else "frame 1 is shown"
    return f"frame {failed + 1} failed; {shown}"


PAGE = Page(place=1, label="Results")
