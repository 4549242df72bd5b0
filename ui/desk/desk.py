"""The desk: joins session, conductor, scene and panels; holds no widgets' details and no maths.

Handlers of widgets call `edit` or `run` and return; what comes of it arrives through `jobs`.
"""

from __future__ import annotations

from typing import Any

from ui.desk.aiming import Aiming
from ui.desk.auto_update import AutoUpdate
from ui.desk.foresight import Foresight
from ui.desk.front import Front
from ui.desk.image_preview import ImagePreviewFollower
from ui.desk.live_press import LivePressFollower
from ui.desk.object_follower import ObjectFollower
from ui.desk.session import Session
from ui.page.editor import Editor
from workbench.core.base.errors import SolveError, WorkbenchError
from workbench.core.result.sensing import Contact
from workbench.live.conductor import Conductor
from workbench.live.requests import (
    DRAWN,
    FORESIGHT,
    IMAGE_PREVIEW,
    LIVE,
    PREDICTION,
    SHAPE,
)
from workbench.planning.running import PARTIAL

OF_A_SENSOR = ("press", "image", "maps", "forces", "learned", PREDICTION)
"""Jobs that nobody waits for once another sensor has been chosen."""


class Desk(Front):
    """The front, and all that follows its state."""

    def __init__(
        self,
        server: Any,
        session: Session,
        conductor: Conductor,
        editor: Editor,
        *,
        fast: bool,
    ) -> None:
        super().__init__(server, session, conductor, editor, fast=fast)
        self.aiming = Aiming(self)
        self.auto_update = AutoUpdate(self)
        self.live_press = LivePressFollower(self)
        self.foresight = Foresight(self)
        self.image_preview = ImagePreviewFollower(self)
        self.object = ObjectFollower(self)
        self._sensor: tuple[str, str] | None = None
        self._built = ""
        """Key of the body that was asked for last; empty once it is there."""
        self._connect()

    def _connect(self) -> None:
        """Who follows what."""
        self.changed.connect(self._follow)
        self.replaced.connect(self._replace)
        self.amended.connect(self._follow_amended)
        self.clicked.connect(self.aiming.aim_at)
        self.shown_results.on_body.connect(self.aiming.show_body)
        self.shown_results.on_body.connect(lambda solid: self.object.follow())
        self.object_drawn.connect(self.live_press.object_drawn)
        self.jobs.on_events = self.refresh_header
        self.jobs.on_idle = self._idle
        self.jobs.on_failed = self._failed

    def _follow(self) -> None:
        """Follow a change of state: live view, stage strip, autosave."""
        self.saving.edited()
        self.auto_update.edited()
        session = self.session
        self._begin()
        self.foresight.follow()
        self.scene.rig.show_optics(session.design.optics)
        self.shown_results.show_stored()
        if self.current("build"):
            self.aiming.keep_aim()
        self.object.follow()
        if not self.current("press"):
            # What was pressed was another press: the skin is at rest again, or follows live.
            self.shown_results.forget("press")
            if not self.live:
                self.scene.clear_frames()
            self.scene.object.place(session.case.press)
        if self.live:
            self.live_press.follow()
        for panel in self.panels:
            panel.refresh()
        self.image_preview.follow()
        self.refresh_header()

    def _follow_amended(self, words: str) -> None:
        """Let all follow who follow an edit: what runs was asked for at the old place."""
        self.saving.edited()
        self.auto_update.edited()
        self.fields.refresh()
        self.log(words)
        if self.live:
            self.live_press.follow()
        self.image_preview.follow()

    def _begin(self) -> None:
        """First of all: the worker builds while the widgets follow, and the old body shows it."""
        session = self.session
        self._follow_sensor()
        key = session.calls()["build"].key
        if session.store.has("build", key):
            # An edit taken back: what was being built for it must not hold up the rest.
            self.conductor.give_up(SHAPE)
            self._built = ""
        elif key != self._built:
            self._built = key
            self.jobs.submit(SHAPE, session.design, session.case, ("build",))

    def _follow_sensor(self) -> None:
        """Take away what was pressed and rendered of another family or another file."""
        sensor = self.session.origin()
        if self._sensor not in (None, sensor):
            self.shown_results.forget_all()
            for job in OF_A_SENSOR:
                # What was asked of the sensor before must not hold up this one.
                self.conductor.stop(job)
            self.scene.rig.forget_image()
            self.scene.body.dim(True)
            self.tell("sensor", None)
            self.refresh_header()
        self._sensor = sensor

    def _replace(self) -> None:
        """Follow a change of many fields at once: undo, a preset, an upload."""
        with self.lock:
            self._begin()
            for panel in self.panels:
                # Another family's widgets come before they are given values.
                panel.refresh()
            self.fields.refresh()
            self.reports.settle()
            self.put_parts_away()
            self.changed()

    def _failed(self, error: WorkbenchError, job: str) -> None:
        """Show the frames that settled before a press failed."""
        if job == LIVE:
            self.live_press.failed()
        elif job == FORESIGHT:
            self.foresight.failed()
        elif job == IMAGE_PREVIEW:
            self.image_preview.failed()
        elif job == DRAWN:
            self.object.failed()
        kept = error.kept if isinstance(error, SolveError) else ""
        if kept and job != LIVE and kept == self.session.calls()["press"].key:
            if self.session.store.has(PARTIAL, kept):
                self.shown_results.fetch(
                    PARTIAL, kept, lambda contact: self._settled(contact, error)
                )

    def _settled(self, contact: Contact, error: WorkbenchError) -> None:
        if isinstance(error, SolveError) and error.kept == self.session.calls()["press"].key:
            self.tell("partial", (contact, error))

    def _idle(self) -> None:
        """Keep what has settled, read what was typed, follow the handles, drop old frames.

        Each on its own, the keeping first: one that fails at each turn must not stop the others.
        """
        steps = (
            self.saving.turn,
            self.reports.turn,
            self.fields.read_typed,
            *(gizmo.turn for gizmo in self.gizmos),
            self.background.turn,
            self.scene.pressed.turn,
            self.auto_update.turn,
            *self.on_turn,
        )
        for step in steps:
            self.guarded(lambda event, step=step: step())(None)

    def refresh_header(self) -> None:
        """Show which stages are done and which are stale."""
        fresh = self.session.fresh()
        building = {} if fresh["build"] or not self.conductor.works_on(SHAPE) else {"build"}
        self.header.show_stages(fresh, self.jobs.running, begun=building)
        self.header.show_design(self.session.design)
        self.auto_update.refresh()
