"""Who follows the desk's signals, and in which order."""

from __future__ import annotations

from ui.desk.aiming import Aiming
from ui.desk.auto_update import AutoUpdate
from ui.desk.desk import Desk
from ui.desk.foresight import Foresight
from ui.desk.headline import HeadlineRow
from ui.desk.image_preview import ImagePreviewFollower
from ui.desk.live_press import LivePressFollower
from ui.desk.object_follower import ObjectFollower
from workbench.core.base.errors import SolveError, WorkbenchError
from workbench.core.result.sensing import Contact
from workbench.live.requests import (
    DRAWN,
    FORESIGHT,
    IMAGE_PREVIEW,
    LIVE,
    PREDICTION,
    SHAPE,
    TOUCH,
)
from workbench.planning.running import PARTIAL

OF_A_SENSOR = ("press", "image", "maps", "forces", "learned", PREDICTION)
"""Jobs that nobody waits for once another sensor has been chosen."""


class Followers:
    """Aim, previews, live press and shown results of one desk, and the order in which they follow.

    Only the desk's signals, its jobs and its pump call them.
    """

    def __init__(self, desk: Desk) -> None:
        self.desk = desk
        self.aiming = Aiming(desk)
        self.auto_update = AutoUpdate(desk)
        self.live_press = LivePressFollower(desk)
        self.foresight = Foresight(desk)
        self.image_preview = ImagePreviewFollower(desk)
        self.object = ObjectFollower(desk)
        self.headline = HeadlineRow(desk)
        self._sensor: tuple[str, str] | None = None
        self._built = ""
        """Key of the body that was asked for last; empty once it is there."""
        self._connect()

    def _connect(self) -> None:
        """Who follows what."""
        desk = self.desk
        desk.changed.connect(self._follow)
        desk.replaced.connect(self._replace)
        desk.amended.connect(self._follow_amended)
        desk.clicked.connect(self.aiming.aim_at)
        desk.shown_results.on_body.connect(self.aiming.show_body)
        desk.shown_results.on_body.connect(lambda solid: self.object.follow())
        desk.live_switched.connect(self.live_press.switch)
        desk.object_drawn.connect(self.live_press.object_drawn)
        desk.jobs.on_events = self.refresh_header
        desk.jobs.on_idle = self._idle
        desk.jobs.on_failed = self._failed

    def _follow(self) -> None:
        """Follow a change of state: live view, stage strip, autosave."""
        desk, session = self.desk, self.desk.session
        desk.saving.edited()
        self.auto_update.edited()
        self._begin()
        if desk.live:
            # Fast contact presses while the widgets follow.
            self.live_press.follow()
        desk.scene.rig.show_optics(session.design.optics)
        desk.shown_results.show_stored()
        if desk.current("build"):
            self.aiming.keep_aim()
        self.object.follow()
        if not desk.current("press"):
            # What was pressed was another press: the skin is at rest again, or follows live.
            desk.shown_results.forget("press")
            if not desk.live:
                desk.scene.clear_frames()
            desk.scene.object.place(session.case.press)
        if desk.live:
            self.live_press.place_gizmo()
        self.foresight.follow()
        for panel in desk.panels:
            panel.refresh()
        self.image_preview.follow()
        self.refresh_header()

    def _follow_amended(self, words: str) -> None:
        """Let all follow who follow an edit: what runs was asked for at the old place."""
        desk = self.desk
        desk.saving.edited()
        self.auto_update.edited()
        desk.fields.refresh()
        desk.log(words)
        if desk.live:
            self.live_press.follow()
        self.image_preview.follow()

    def _begin(self) -> None:
        """First of all: the worker builds while the widgets follow, and the old body shows it."""
        desk, session = self.desk, self.desk.session
        self._follow_sensor()
        key = session.calls()["build"].key
        if session.store.has("build", key):
            # An edit taken back: what was being built for it must not hold up the rest.
            desk.conductor.give_up(SHAPE)
            self._built = ""
        elif key != self._built:
            self._built = key
            desk.jobs.submit(SHAPE, session.design, session.case, ("build",))

    def _follow_sensor(self) -> None:
        """Take away what was pressed and rendered of another family or another file."""
        desk = self.desk
        sensor = desk.session.origin()
        if self._sensor not in (None, sensor):
            desk.shown_results.forget_all()
            for job in OF_A_SENSOR:
                # What was asked of the sensor before must not hold up this one.
                desk.conductor.stop(job)
            desk.scene.rig.forget_image()
            desk.scene.body.dim(True)
            desk.tell("sensor", None)
            self.headline.forget()
            self.refresh_header()
        self._sensor = sensor

    def _replace(self) -> None:
        """Follow a change of many fields at once: undo, a preset, an upload."""
        desk = self.desk
        with desk.lock:
            self._begin()
            for panel in desk.panels:
                # Another family's widgets come before they are given values.
                panel.refresh()
            desk.fields.refresh()
            desk.reports.settle()
            desk.put_parts_away()
            desk.changed()

    def _failed(self, error: WorkbenchError, job: str) -> None:
        """Show the frames that settled before a press failed."""
        desk = self.desk
        if job == LIVE:
            self.live_press.failed()
        elif job == TOUCH:
            self.live_press.touch_failed()
        elif job == FORESIGHT:
            self.foresight.failed()
        elif job == IMAGE_PREVIEW:
            self.image_preview.failed()
        elif job == DRAWN:
            self.object.failed()
        kept = error.kept if isinstance(error, SolveError) else ""
        if kept and job != LIVE and kept == desk.session.calls()["press"].key:
            if desk.session.store.has(PARTIAL, kept):
                desk.shown_results.fetch(
                    PARTIAL, kept, lambda contact: self._settled(contact, error)
                )

    def _settled(self, contact: Contact, error: WorkbenchError) -> None:
        if isinstance(error, SolveError) and error.kept == self.desk.session.calls()["press"].key:
            self.desk.tell("partial", (contact, error))

    def _idle(self) -> None:
        """Keep what has settled, read what was typed, follow the handles, drop old frames.

        Each on its own, the keeping first: one that fails at each turn must not stop the others.
        """
        desk = self.desk
        steps = (
            desk.saving.turn,
            desk.reports.turn,
            desk.fields.read_typed,
            *(gizmo.turn for gizmo in desk.gizmos),
            desk.background.turn,
            desk.scene.pressed.turn,
            self.auto_update.turn,
            *desk.on_turn,
        )
        for step in steps:
            desk.guarded(lambda event, step=step: step())(None)

    def refresh_header(self) -> None:
        """Show which stages are done and which are stale."""
        desk = self.desk
        fresh = desk.session.fresh()
        building = {} if fresh["build"] or not desk.conductor.works_on(SHAPE) else {"build"}
        desk.header.show_stages(fresh, desk.jobs.running, begun=building)
        desk.header.show_design(desk.session.design)
        self.auto_update.refresh()
