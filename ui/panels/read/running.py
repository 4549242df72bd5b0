"""Reading: one photograph, or one frame of a camera after the other, and how to stop it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import viser

from ui.desk.desk import Desk
from ui.page.offer import offer
from ui.page.plain import plain
from workbench.core.base.errors import Cancelled, DesignError
from workbench.core.base.units import human_seconds
from workbench.live.preview_call import PreviewCall
from workbench.live.requests import Finished, Progress
from workbench.reading.calls import CAMERA, READING, ReadFrame, ReadPhoto, TakeIdle
from workbench.reading.kept_readings import KeptReadings
from workbench.reading.shown_reading import ShownReading
from workbench.system.names import NONE

OVER = "The video is over."


class ReadRun:
    """Widgets that begin and end it."""

    def __init__(self, desk: Desk, kept: KeptReadings, on_arrived: Callable[[], None]) -> None:
        self.desk, self.kept = desk, kept
        self.on_arrived = on_arrived
        self.on_read: Callable[[ShownReading], None] = lambda found: None
        """Set by the page: shows a reading."""
        self.following = False
        """Whether frame after frame is asked for."""
        gui, guarded = desk.server.gui, desk.guarded
        self.choice = gui.add_dropdown("Photo to read", (NONE,), hint="Of those that were loaded")
        hint = "Seconds for the first, which opens the light; then a fraction of one each"
        self.start = gui.add_button("Read photo", icon=viser.Icon.EYE, hint=hint)
        self.start.on_click(guarded(self._begin))
        desk.reports.beside(READING)
        self.progress = gui.add_markdown("")
        self.folder = gui.add_folder("From a camera", expand_by_default=False)
        with self.folder:
            hint = "0 is the first camera of the computer that the workbench runs on; or the "
            hint += "address of a stream; or the name of a video in the project's folder"
            self.source = gui.add_text("Camera or video", "0", hint=hint)
            hint = "Nothing may touch the sensor: the mean of eight frames"
            rest = gui.add_button("Take idle photo", hint=hint)
            rest.on_click(guarded(self._rest))
            hint = "Reads frame after frame, each from where the one before ended"
            self.follow = gui.add_button("Follow camera", icon=viser.Icon.VIDEO, hint=hint)
            self.follow.on_click(guarded(self._follow))
        hint = "What was read stays on show"
        self.stop = gui.add_button("Stop reading", color="red", visible=False, hint=hint)
        self.stop.on_click(guarded(self._stop))
        desk.jobs.on_preview[READING] = lambda found, request: self.on_read(found)
        desk.jobs.on_preview[CAMERA] = lambda found, request: self._came(found)
        desk.on_turn.append(self._turn)

    def refresh(self) -> None:
        """Offer the photographs of the set."""
        offer(self.choice, self.kept.photos or (NONE,))

    def _expect_idle(self) -> None:
        if not self.kept.has_idle:
            raise DesignError(
                "there is no idle photo",
                hint="load the sensor with nothing on it as idle.png, or take it from the camera",
            )

    def _begin(self, event: Any) -> None:
        self.desk.reports.begin()
        self.desk.fields.read_typed(now=True)
        self._expect_idle()
        if self.choice.value not in self.kept.photos:
            raise DesignError(
                "there is no photo to read", hint="load photographs of the touched sensor"
            )
        call = ReadPhoto(
            design=self.desk.session.design,
            folder=self.kept.folder,
            photo=self.choice.value,
            out=self.kept.out,
        )
        self._ask(READING, call)

    def _rest(self, event: Any) -> None:
        self.desk.reports.begin()
        self._ask(CAMERA, TakeIdle(source=self.source.value, project=self.kept.root.parent))

    def _follow(self, event: Any) -> None:
        self.desk.reports.begin()
        self.desk.fields.read_typed(now=True)
        self._expect_idle()
        self.following = True
        self._next()

    def _next(self) -> None:
        call = ReadFrame(
            design=self.desk.session.design,
            folder=self.kept.folder,
            source=self.source.value,
            project=self.kept.root.parent,
        )
        self._ask(CAMERA, call)

    def _ask(self, job: str, call: PreviewCall) -> None:
        self.desk.jobs.ask(job, call, self.desk.session.state, self._ended)
        self._show(busy=True, words="Begins ...")

    def _came(self, found: ShownReading | np.ndarray | None) -> None:
        """Take a frame: a reading, the mean of untouched ones, or the end of a video."""
        if isinstance(found, np.ndarray):
            self.kept.rest(found)
            self.on_arrived()
        elif found is None:
            self.following = False
            self.desk.reports.notify("Camera", OVER)
        else:
            self.on_read(found)

    def _stop(self, event: Any) -> None:
        self.following = False
        for job in (READING, CAMERA):
            self.desk.conductor.stop(job)

    def _ended(self, finished: Finished) -> None:
        error = finished.error
        if error is None and self.following and finished.job == CAMERA:
            self._next()
            return
        self.following = False
        if error is not None and not isinstance(error, Cancelled):
            self.desk.reports.report(error, job=READING)
        took = f"Took {human_seconds(finished.seconds)}." if error is None else ""
        self._show(busy=False, words=took)

    def _turn(self) -> None:
        """Say how far it is."""
        for job in (READING, CAMERA):
            now = self.desk.jobs.running.get(job)
            if now is not None:
                self._show(busy=True, words=self._words(now))

    def _words(self, now: Progress) -> str:
        if self.following and now.fraction > 0.8:
            return "Follows the camera."
        return f"**{100.0 * now.fraction:.0f} %** {plain(now.note)}"

    def _show(self, *, busy: bool, words: str) -> None:
        if self.progress.content != words:
            self.progress.content = words
        for handle, wanted in ((self.stop, busy), (self.start, not busy), (self.follow, not busy)):
            if handle.visible != wanted:
                handle.visible = wanted
