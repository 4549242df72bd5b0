"""The calibration itself: whose lights, start, how far it is, stop; what was computed is stored."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import viser

from ui.desk.desk import Desk
from ui.page.plain import plain
from workbench.calibration.seen.photo_set import FEWEST, IDLE
from workbench.core.base.errors import Cancelled, DesignError
from workbench.core.base.units import human_seconds
from workbench.live.requests import Finished, Progress
from workbench.photographs.calls import CALIBRATION, Calibrate
from workbench.photographs.kept_photos import KeptPhotos, Use

LIGHTS = {
    "the design's, if they explain the photographs": "auto",
    "the design's own": "known",
    "looked for around the body": "unknown",
}
"""Words, and what the calibration calls it."""
FITTED = {
    "all that the photographs tell": "all",
    "powers and colours of the lights": "powers",
}
"""The same of what is fitted."""
STOPPED = "Stopped; *Calibrate* goes on where it was."


class RunFolder:
    """Widgets of the folder."""

    def __init__(self, desk: Desk, kept: KeptPhotos, on_done: Callable[[], None]) -> None:
        self.desk, self.kept = desk, kept
        self.on_done = on_done
        self.ending = ""
        """How the last one ended, for people."""
        gui, guarded = desk.server.gui, desk.guarded
        self.folder = gui.add_folder("Fit to the photographs", visible=False)
        with self.folder:
            hint = "Where the design's LEDs are not those of the sensor, have them looked for"
            self.lights = gui.add_dropdown("Lights are", tuple(LIGHTS), hint=hint)
            hint = "Powers and colours alone takes less than half the time; camera and LEDs stay"
            self.fitted = gui.add_dropdown("Fitted are", tuple(FITTED), hint=hint)
            hint = "Minutes: balls are pressed, light is traced, both are stored"
            self.start = gui.add_button("Calibrate", icon=viser.Icon.ADJUSTMENTS, hint=hint)
            self.start.on_click(guarded(self._begin))
            desk.reports.beside(CALIBRATION)
            self.progress = gui.add_markdown("")
            hint = "What was computed is stored; Calibrate goes on where it was"
            self.stop = gui.add_button("Stop calibration", color="red", visible=False, hint=hint)
            self.stop.on_click(guarded(lambda event: desk.conductor.stop(CALIBRATION)))
        desk.jobs.on_preview[CALIBRATION] = lambda found, request: None
        desk.on_turn.append(self._turn)

    def _begin(self, event: Any) -> None:
        desk, kept = self.desk, self.kept
        desk.reports.begin()
        desk.fields.read_typed(now=True)
        kept.expect_ready()
        design = desk.session.design
        height, width = kept.image(IDLE).shape[:2]
        camera = design.optics.camera
        if (camera.width_px, camera.height_px) != (width, height):
            raise DesignError(
                f"the camera of the design has {camera.width_px} x {camera.height_px} pixels, the "
                f"photographs {width} x {height}",
                hint="open Camera and press Take size of photographs",
            )
        call = Calibrate(
            design=design,
            folder=kept.folder,
            held_out=kept.held_out,
            lights=LIGHTS[self.lights.value],
            refining=FITTED[self.fitted.value],
            out=kept.out,
        )
        self.ending = ""
        desk.jobs.ask(CALIBRATION, call, desk.session.state, self._ended)
        self._show(busy=True, words="Begins ...")

    def _ended(self, finished: Finished) -> None:
        if finished.error is None:
            self.ending = f"Done in {human_seconds(finished.seconds)}."
            self.desk.log(f"calibration: finished in {human_seconds(finished.seconds)}")
        elif isinstance(finished.error, Cancelled):
            self.ending = STOPPED
        else:
            self.ending = ""
            self.desk.reports.report(finished.error, job=CALIBRATION)
        self._show(busy=False, words=self.ending)
        self.on_done()

    def _turn(self) -> None:
        """Say how far it is."""
        now = self.desk.jobs.running.get(CALIBRATION)
        if now is not None:
            self._show(busy=True, words=progress_words(now))

    def _show(self, *, busy: bool, words: str) -> None:
        if self.progress.content != words:
            self.progress.content = words
        for handle, wanted in ((self.stop, busy), (self.start, not busy)):
            if handle.visible != wanted:
                handle.visible = wanted

    def refresh(self) -> None:
        """Say what it would be fitted to."""
        if self.desk.conductor.works_on(CALIBRATION):
            return
        self._show(busy=False, words=self.ending or ready_words(self.kept))


def ready_words(kept: KeptPhotos) -> str:
    """What a calibration would be fitted to, or what it waits for."""
    fitted, held = len(kept.fitted), len(kept.held_out)
    if not kept.has_idle or fitted < FEWEST:
        return f"Needs an idle photo and at least {FEWEST} photographs to fit to."
    open_ones = sum(e.circle is None for e in kept.photos if e.use is not Use.LEAVE)
    if open_ones:
        return f"{open_ones} photographs have no contact yet: see *Contacts*."
    tested = f", tested on {held}" if held else "; hold two or three out to test it on them"
    return f"Fits the design's light to {fitted} photographs{tested}."


def progress_words(now: Progress) -> str:
    """How far it is and how long it still takes."""
    left = f", about {human_seconds(now.eta_s)} left" if now.eta_s is not None else ""
    note = f" · {plain(now.note)}" if now.note else ""
    return f"**{100.0 * now.fraction:.0f} %**{left}{note}"
