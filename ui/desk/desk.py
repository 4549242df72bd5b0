"""The desk: session, conductor, scene and widgets that all parts of one server's front share.

Holds no widgets' details and no maths: handlers of widgets call `edit` or `run` and return; what
comes of it arrives through `jobs`. The parts tell each other by the desk's signals; who follows
them is told in `ui.desk.followers`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any, Protocol

import numpy as np

from ui.desk.jobs import Jobs
from ui.desk.reports import Reports
from ui.desk.saving import Saving
from ui.desk.session import Session
from ui.desk.shown_results import ShownResults
from ui.desk.signal import Signal
from ui.page.background_thread import BackgroundThread
from ui.page.editor import Editor
from ui.page.fields import Fields
from ui.page.gallery import Galleries
from ui.page.header import Header
from ui.scene.gizmo import Gizmo
from ui.scene.pointing import rests
from ui.scene.scene import Scene
from workbench.core.base.errors import WorkbenchError
from workbench.core.design.design import SensorDesign
from workbench.edit.forms import resolve_shape
from workbench.edit.item_fields import read_field
from workbench.live.conductor import Conductor
from workbench.live.requests import Finished


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
        self.server, self.session = server, session
        self.conductor, self.editor = conductor, editor
        self.changed: Signal[[]] = Signal()
        """The state has changed: all that shows it is to follow."""
        self.replaced: Signal[[]] = Signal()
        """Many fields have changed at once: undo, a preset, an upload."""
        self.amended: Signal[[str]] = Signal()
        """The desk itself has corrected the state; told in words."""
        self.clicked: Signal[[Any]] = Signal()
        """A click into the 3D view, as viser tells it."""
        self.rested: Signal[[np.ndarray, np.ndarray]] = Signal()
        """The mouse rests over the skin; told by its ray, while a page is asked to tell it."""
        self.object_drawn: Signal[[]] = Signal()
        """The object in the 3D view has another shape, or stands elsewhere."""
        self.put_parts_away: Signal[[]] = Signal()
        """The sensor is to be looked at, not the parts to print."""
        self.live_said: Signal[[str]] = Signal()
        """How the live press goes, in words."""
        self.figured: Signal[[Mapping[str, float]]] = Signal()
        """Figures of the design as it stands, as far as they are known."""
        self.limited: Signal[[]] = Signal()
        """The project's own limits of figures, or prices, have changed."""
        self.edited: Signal[[str]] = Signal()
        """A field was changed by hand; told by its name."""
        self.live_switched: Signal[[bool]] = Signal()
        """The live press is wanted, or no longer."""
        self.live = False
        """Whether each change is pressed at once, by the live press."""
        self.fields = Fields(server, self.read, self.edit)
        self.reports = Reports(server, session, self.fields)
        self.reports.on_log = lambda lines: self.tell("log", lines)
        session.store.on_message = self.reports.log_soon
        self.guarded = self.reports.guarded
        self.log = self.reports.log
        self.galleries = Galleries(server, editor)
        self.background = BackgroundThread(on_error=self.reports.tell)
        on_click = self.guarded(self._pointed)
        self.scene = Scene(server, fast=fast, on_click=on_click, background=self.background)
        self.panels: list[Panel] = []
        self.pick: Callable[[int], bool] = lambda face: False
        """Set by the panel that labels faces: whether it took a click on this membrane face."""
        self.probe: Callable[[np.ndarray, np.ndarray], bool] = lambda origin, direction: False
        """Set by the panel of maps: whether it told the value where a click's ray meets the map."""
        self.click_handlers: list[Callable[[np.ndarray, np.ndarray], bool]] = []
        """Asked in turn, with a click's ray, before the click aims: the first that takes it has it.

        Panels add themselves, for example while two points are being measured.
        """
        on_cancel = self.guarded(lambda event: conductor.cancel())
        self.header = Header(server.gui, on_cancel=on_cancel)
        self.reports.banner = self.header.banner
        self.shown_results = ShownResults(session, self.background)
        self.shown_results.on_notices.connect(self.header.show_notice)
        self.shown_results.on_result.connect(self.tell)
        self.current = self.shown_results.current
        self.jobs = Jobs(conductor, self.reports, self.header)
        self.jobs.on_done = self.shown_results.stage_done
        self.jobs.asked_now = session.asks_now
        self.on_turn: list[Callable[[], None]] = []
        """What else is looked after each time the pump turns."""
        self.gizmos: list[Gizmo] = []
        """Handles in the 3D view, asked each time the pump turns."""
        self.saving = Saving(session, self.reports, self.header.unsaved)
        self._covering: set[str] = set()
        self.lock = self.reports.lock

    def read(self, path: str) -> Any:
        """Value of a field of the state; shape parameters have their defaults filled in."""
        if path.startswith("design.shape."):
            design = self.session.design
            shape = resolve_shape(design.family, design.shape)
            return getattr(shape, path.rsplit(".", 1)[1])
        return read_field(self.session.state, path)

    def _pointed(self, event: Any) -> None:
        if rests(event):
            self.rested(np.asarray(event.ray_origin), np.asarray(event.ray_direction))
        else:
            self.clicked(event)

    def edit(self, path: str, value: Any) -> None:
        """Change one field; a refused value is explained and leaves the last good state."""
        with self.lock:
            try:
                self.session.change(path, value)
            except WorkbenchError as error:
                self.fields.refuse(path)
                self.reports.report(error, edited=path)
                return
            self.reports.settle(path)
            self.edited(path)
            if not path.startswith(("design.mould", "design.housing", "design.casting")):
                self.put_parts_away()
            self.changed()
            if path.startswith("design.optics") and not self.live:
                # The pressed skin is opaque; the one at rest shows LEDs and camera.
                self.scene.show_frame(0)

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

    def cover(self, what: str, shown: bool) -> None:
        """Tell all panels whether parts, or the edges of a mesh, are looked at, not the press."""
        before = bool(self._covering)
        if shown:
            self._covering.add(what)
        else:
            self._covering.discard(what)
        if bool(self._covering) != before:
            self.tell("covered", not before)
