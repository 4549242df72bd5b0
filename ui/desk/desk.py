"""The desk: joins session, conductor, scene and panels; holds no widgets' details and no maths.

Handlers of widgets call `edit` or `run` and return; what comes of it arrives through `jobs`.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Protocol

import numpy as np

from ui.desk.aiming import Aiming
from ui.desk.auto_update import AutoUpdate
from ui.desk.foresight import Foresight
from ui.desk.image_preview import ImagePreviewFollower
from ui.desk.jobs import Jobs
from ui.desk.live_press import LivePressFollower
from ui.desk.object_follower import ObjectFollower
from ui.desk.reports import Reports
from ui.desk.saving import Saving
from ui.desk.session import Session
from ui.desk.shown_results import ShownResults
from ui.page.background_thread import BackgroundThread
from ui.page.editor import Editor
from ui.page.fields import Fields
from ui.page.gallery import Galleries
from ui.page.header import Header
from ui.scene.gizmo import Gizmo
from ui.scene.scene import Scene
from workbench.core.base.errors import SolveError, WorkbenchError
from workbench.core.design.design import SensorDesign
from workbench.core.result.sensing import Contact
from workbench.edit.forms import resolve_shape
from workbench.edit.item_fields import read_field
from workbench.live.conductor import Conductor
from workbench.live.requests import (
    DRAWN,
    FORESIGHT,
    IMAGE_PREVIEW,
    LIVE,
    PREDICTION,
    SHAPE,
    Finished,
)
from workbench.planning.running import PARTIAL

OF_A_SENSOR = ("press", "image", "maps", "forces", "learned", PREDICTION)
"""Jobs that nobody waits for once another sensor has been chosen."""


class Panel(Protocol):
    """A part of the front that follows state and results."""

    def refresh(self) -> None:
        """Show the state as it stands."""
        ...

    def show(self, stage: str, result: Any) -> None:
        """Show a new result."""
        ...


class Desk:
    """One server's front; all tabs of it show the same desk."""

    def __init__(
        self,
        server: Any,
        session: Session,
        conductor: Conductor,
        editor: Editor,
        *,
        fast: bool,
    ) -> None:
        self.server = server
        self.editor = editor
        self.session = session
        self.conductor = conductor
        self.fields = Fields(server, self.read, self.edit)
        self.reports = Reports(server, session, self.fields)
        self.reports.on_log = lambda lines: self.tell("log", lines)
        session.store.on_message = self.reports.log_soon
        self.guarded = self.reports.guarded
        self.log = self.reports.log
        self.galleries = Galleries(server, editor)
        self.aiming = Aiming(self)
        self.background = BackgroundThread(on_error=self.reports.tell)
        on_click = self.guarded(self.aiming.clicked)
        self.scene = Scene(server, fast=fast, on_click=on_click, background=self.background)
        self.shown_results = ShownResults(self)
        self.current = self.shown_results.current
        self.panels: list[Panel] = []
        self.put_parts_away: Callable[[], None] = lambda: None
        """Set by the panel that shows the parts."""
        self.pick: Callable[[int], bool] = lambda face: False
        """Set by the panel that labels faces: whether it took a click on this membrane face."""
        self.probe: Callable[[np.ndarray, np.ndarray], bool] = lambda origin, direction: False
        """Set by the panel of maps: whether it told the value where a click's ray meets the map."""
        self.click_handlers: list[Callable[[np.ndarray, np.ndarray], bool]] = []
        """Asked in turn, with a click's ray, before the click aims: the first that takes it has it.

        Panels add themselves, for example while two points are being measured.
        """
        self.header = Header(
            server.gui,
            on_cancel=self.guarded(lambda event: conductor.cancel()),
        )
        self.auto_update = AutoUpdate(self)
        self.reports.banner = self.header.banner
        self.jobs = Jobs(conductor, self.reports, self.header)
        self.jobs.on_done = self.shown_results.stage_done
        self.jobs.asked_now = session.asks_now
        self.jobs.on_events = self.refresh_header
        self.jobs.on_idle = self._idle
        self.jobs.on_failed = self._failed
        self.on_turn: list[Callable[[], None]] = []
        """What else is looked after each time the pump turns."""
        self.gizmos: list[Gizmo] = []
        """Handles in the 3D view, asked each time the pump turns."""
        self.live_press = LivePressFollower(self)
        self.gizmos.append(self.live_press.gizmo)
        self.jobs.on_preview[LIVE] = self.live_press.show
        self.foresight = Foresight(self)
        self.image_preview = ImagePreviewFollower(self)
        self.object = ObjectFollower(self)
        self.saving = Saving(session, self.reports, self.header.unsaved)
        self._sensor: tuple[str, str] | None = None
        self._built = ""
        """Key of the body that was asked for last; empty once it is there."""
        self._covering: set[str] = set()
        self._lock = self.reports.lock

    def read(self, path: str) -> Any:
        """Value of a field of the state; shape parameters have their defaults filled in."""
        if path.startswith("design.shape."):
            design = self.session.design
            shape = resolve_shape(design.family, design.shape)
            return getattr(shape, path.rsplit(".", 1)[1])
        return read_field(self.session.state, path)

    def edit(self, path: str, value: Any) -> None:
        """Change one field; a refused value is explained and leaves the last good state."""
        with self._lock:
            try:
                self.session.change(path, value)
            except WorkbenchError as error:
                self.fields.refuse(path)
                self.reports.report(error, edited=path)
                return
            self.reports.settle(path)
            if not path.startswith(("design.mould", "design.housing", "design.casting")):
                self.put_parts_away()
            self.changed()
            if path.startswith("design.optics") and not self.live_press.on:
                # The pressed skin is opaque; the one at rest shows LEDs and camera.
                self.scene.show_frame(0)

    def changed(self) -> None:
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
            if not self.live_press.on:
                self.scene.clear_frames()
            self.scene.object.place(session.case.press)
        if self.live_press.on:
            self.live_press.follow()
        for panel in self.panels:
            panel.refresh()
        self.image_preview.follow()
        self.refresh_header()

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

    def cover(self, what: str, shown: bool) -> None:
        """Tell all panels whether parts, or the edges of a mesh, are looked at, not the press."""
        before = bool(self._covering)
        if shown:
            self._covering.add(what)
        else:
            self._covering.discard(what)
        if bool(self._covering) != before:
            self.tell("covered", not before)

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

    def replaced(self) -> None:
        """Follow a change of many fields at once: undo, a preset, an upload."""
        with self._lock:
            self._begin()
            for panel in self.panels:
                # Another family's widgets come before they are given values.
                panel.refresh()
            self.fields.refresh()
            self.reports.settle()
            self.put_parts_away()
            self.changed()

    def run(self, job: str, wanted: tuple[str, ...]) -> None:
        """Compute stages for the state as it stands."""
        self.reports.begin()
        self.fields.read_typed(now=True)
        if job != "parts":
            self.put_parts_away()
        self.tell("run", job)
        self.jobs.submit(job, self.session.design, self.session.case, wanted)

    def trial(
        self, job: str, design: SensorDesign, wanted: str, then: Callable[[Finished], None]
    ) -> None:
        """Compute a stage of a design that is not the state; `then` decides by how it ended."""
        self.jobs.submit(job, design, self.session.case, (wanted,), then)

    def tell(self, stage: str, result: Any) -> None:
        """Hand a result, or another piece of news, to all panels."""
        for panel in self.panels:
            panel.show(stage, result)

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
