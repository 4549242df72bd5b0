"""The desk: joins session, conductor, scene and panels; holds no widgets' details and no maths.

Handlers of widgets call `edit` or `run` and return. One pump thread drains the conductor's events
into widgets ten times a second and saves the session once edits have settled.
"""

from __future__ import annotations

import contextlib
import html
import sys
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
import viser

from ui.panels.fields import Fields, read_field, whole_shape
from ui.scene import Scene
from ui.session import Session
from workbench.conductor import Conductor, Event, Finished, Progress, StageDone
from workbench.core.errors import Cancelled, WorkbenchError
from workbench.core.units import human_seconds
from workbench.forms import resolve_shape

PUMP_S = 0.1
AUTOSAVE_S = 1.0
"""Quiet time after an edit before the design is written [s]."""
NOTICE_S = 15.0
AIM_LIMIT_MM = 4.0
"""Distance from target to skin at which the target follows; the solver refuses beyond 5 mm."""
STRIP = {
    "build": "Shape",
    "mesh": "Mesh",
    "bake": "Light",
    "press": "Contact",
    "shoot": "Image",
    "mould": "Mould",
}
"""Stages of the strip and their names for people."""


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

    def __init__(self, server: Any, session: Session, conductor: Conductor, *, fast: bool) -> None:
        self.server = server
        self.session = session
        self.conductor = conductor
        self.scene = Scene(server, fast=fast, on_aim=self.guarded(self._aim))
        self.fields = Fields(server, self.read, self.edit)
        self.panels: list[Panel] = []
        self.put_mould_away: Callable[[], None] = lambda: None
        """Set by the panel that shows the mould."""
        self.log_lines: list[str] = []
        self._edited: float | None = None
        self._running: dict[str, Progress] = {}
        self._shown: dict[str, str] = {}
        self._lock = threading.RLock()
        self._build_header()

    def _build_header(self) -> None:
        gui = self.server.gui
        self.title = gui.add_markdown("")
        self.strip = gui.add_markdown("")
        self.banner = gui.add_markdown("", visible=False)
        # A panel of its own: widgets must not move under the mouse when a job starts or ends.
        self.job = gui.add_panel(visible=False)
        with self.job.add_tab("Running", viser.Icon.LOADER):
            self.progress = gui.add_progress_bar(0.0, animated=True)
            self.progress_text = gui.add_markdown("")
            cancel = gui.add_button("Cancel", color="red")
            cancel.on_click(self.guarded(lambda event: self.conductor.cancel()))
        self.job.float(x=405, y=15, width=330)

    def read(self, path: str) -> Any:
        """Value of a field of the state; shape parameters have their defaults filled in."""
        if path.startswith("design.shape."):
            design = self.session.design
            shape = resolve_shape(design.family, design.shape)
            return whole_shape(shape)[path.rsplit(".", 1)[1]]
        return read_field(self.session.state, path)

    def guarded(self, handler: Callable[[Any], None]) -> Callable[[Any], None]:
        """A widget callback whose errors reach the designer instead of the terminal only."""

        def call(event: Any) -> None:
            try:
                # viser calls from a pool of threads; the lock is re-entrant, because a value set
                # by a handler runs that widget's own handler at once.
                with self._lock:
                    handler(event)
            except WorkbenchError as error:
                self.report(error)
            except Exception as bug:
                self.crash(bug)

        return call

    def edit(self, path: str, value: Any) -> None:
        """Change one field; a refused value is explained and leaves the last good state."""
        with self._lock:
            try:
                self.session.change(path, value)
            except WorkbenchError as error:
                self.report(error, quiet=True)
                return
            self.fields.clear_complaints()
            self.banner.visible = False
            if not path.startswith("design.mould"):
                self.put_mould_away()
            self.changed()
            if path.startswith("design.optics"):
                # The pressed skin is opaque; the one at rest shows LEDs and camera.
                self.scene.show_frame(0)

    def changed(self) -> None:
        """Follow a change of state: live view, stage strip, autosave."""
        self._edited = time.monotonic()
        session = self.session
        if not session.store.has("build", session.calls()["build"].key):
            # First of all: the worker builds while the widgets follow.
            self.conductor.submit("shape", session.design, session.case, ("build",))
        self.scene.show_lights(session.design.optics.ring)
        self.scene.show_camera(session.design.optics.camera)
        self.show_stored()
        if self.current("build"):
            self._keep_aim()
        if not self.current("press"):
            # What was pressed was another press: the skin is at rest again.
            self._shown.pop("press", None)
            self.scene.clear_frames()
            self.scene.place_indenter(session.case.press)
        for panel in self.panels:
            panel.refresh()
        self.refresh_strip()

    def _aim(self, event: Any) -> None:
        """A click on the skin moves the target there."""
        target = self.scene.aim(np.asarray(event.ray_origin), np.asarray(event.ray_direction))
        if target is not None:
            self.edit("case.press.target_mm", tuple(round(x, 2) for x in target))
            self.fields.refresh()
            self.log(f"target {target[0]:.1f}, {target[1]:.1f}, {target[2]:.1f} mm")

    def replaced(self) -> None:
        """Follow a change of many fields at once: undo, a preset, an upload."""
        with self._lock:
            self.fields.refresh()
            self.fields.clear_complaints()
            self.banner.visible = False
            self.changed()

    def show_stored(self) -> None:
        """Show every result that is stored for the state as it stands."""
        for stage in ("build", "press", "shoot", "mould"):
            # Asked anew each time: showing a body may move the target, and with it later keys.
            key = self.session.calls()[stage].key
            if self.session.store.has(stage, key):
                self._show(stage, key)

    def run(self, topic: str, wanted: tuple[str, ...]) -> None:
        """Compute stages for the state as it stands."""
        self.banner.visible = False
        if topic != "mould":
            self.put_mould_away()
        self.log(f"{topic}: started")
        self.conductor.submit(topic, self.session.design, self.session.case, wanted)

    def _show(self, stage: str, key: str) -> None:
        if self._shown.get(stage) == key:
            return
        result = self.session.store.load(stage, key)
        self._shown[stage] = key
        if stage == "build":
            # Another body: what was shown of the old one goes.
            self._shown.pop("press", None)
            self._shown.pop("mould", None)
            self.scene.show_solid(result)
            self._keep_aim()
            self.scene.show_indenter(self.session.case.indenter, self.session.case.press)
            if result.notice:
                self.notify("Shape", result.notice, color="yellow")
        for panel in self.panels:
            panel.show(stage, result)

    def _keep_aim(self) -> None:
        """Bring a target that a change of shape left in the air back to the skin, and say so."""
        point, distance_mm = self.scene.nearest(self.session.case.press.target_mm)
        if distance_mm > AIM_LIMIT_MM:
            x, y, z = (round(float(c), 2) for c in point)
            self.session.amend("case.press.target_mm", (x, y, z))
            self._edited = time.monotonic()
            self.fields.refresh()
            self.log(
                f"the skin moved {distance_mm:.1f} mm from the target: it is now at {x}, {y}, {z}"
            )

    def current(self, stage: str) -> bool:
        """Whether what is shown of a stage belongs to the state as it stands."""
        return self._shown.get(stage) == self.session.calls()[stage].key

    def pump_forever(self) -> None:
        """Drain events into widgets until the process ends."""
        while True:
            try:
                # Wakes at once for an event, and regularly for the autosave.
                self.pump(self.conductor.wait(PUMP_S))
            except Exception as bug:
                self.crash(bug)

    def pump(self, events: Sequence[Event]) -> None:
        """Handle events, then the autosave."""
        with self._lock:
            for event in events:
                try:
                    self._handle(event)
                except WorkbenchError as error:
                    self.report(error)
                except Exception as bug:
                    self.crash(bug)
            if events:
                self._refresh_progress()
                self.refresh_strip()
            if self._edited is not None and time.monotonic() - self._edited > AUTOSAVE_S:
                self._edited = None
                try:
                    self.session.autosave()
                except WorkbenchError as error:
                    self.report(error)

    def _handle(self, event: Event) -> None:
        if isinstance(event, Progress):
            self._running[event.topic] = event
        elif isinstance(event, StageDone):
            stage, key = event.outcome.stage, event.outcome.key
            if not event.outcome.cached:
                name = STRIP.get(stage, stage)
                self.log(f"{name} done in {human_seconds(event.outcome.seconds)}")
            if self.session.calls()[stage].key == key:
                self._show(stage, key)
        else:
            self._finish(event)

    def _finish(self, event: Finished) -> None:
        self._running.pop(event.topic, None)
        error = event.error
        if event.superseded:
            self.log(f"{event.topic}: replaced by a newer request")
        elif error is None:
            if event.topic != "shape":
                self.log(f"{event.topic}: finished in {human_seconds(event.seconds)}")
        elif isinstance(error, Cancelled):
            self.log(f"{event.topic}: cancelled")
            if event.topic != "shape":
                self.notify("Cancelled", f"{event.topic} was stopped; earlier results are kept")
        else:
            self.report(error)

    def _refresh_progress(self) -> None:
        shown = [p for topic, p in self._running.items() if topic != "shape"]
        visible = bool(shown)
        if self.job.visible != visible:
            self.job.visible = visible
        if shown:
            now = shown[-1]
            self.progress.value = 100.0 * now.fraction
            left = f"about {human_seconds(now.eta_s)} left" if now.eta_s is not None else ""
            name = STRIP.get(now.stage, now.stage)
            parts = (f"{name} {100 * now.fraction:.0f} %", left, now.note)
            self.progress_text.content = " · ".join(part for part in parts if part)

    def refresh_strip(self) -> None:
        """Show which stages are done and which are stale."""
        fresh = self.session.fresh()
        running = {p.stage for p in self._running.values()}
        marks = {True: "✓", False: "○"}
        text = " &nbsp;".join(
            f"{name} {'▶' if stage in running else marks[fresh[stage]]}"
            for stage, name in STRIP.items()
        ).replace(" ✓", "&nbsp;✓")
        if self.strip.content != text:
            self.strip.content = text
        design = self.session.design
        title = f"**{html.escape(design.name)}** · {html.escape(design.family)}"
        if self.title.content != title:
            self.title.content = title

    def report(self, error: WorkbenchError, *, quiet: bool = False) -> None:
        """Show an error at its field; in a banner too, unless it answers an edit there."""
        at_field = self.fields.complain(error)
        words = self.fields.in_words(error.message)
        hint = ""
        if error.hint and "\n" not in error.hint:
            hint = self.fields.in_words(f" {error.hint[0].upper()}{error.hint[1:]}.")
        self.log(f"{type(error).__name__}: {words} {error.hint}")
        if not (quiet and at_field):
            text = html.escape(f"{words}.{hint}")
            self.banner.content = f"<span style='color:#e5484d'>**{text}**</span>"
            self.banner.visible = True
        if not at_field:
            self.notify("Not possible", f"{words}.{hint}", color="red")
        if "\n" in error.hint:
            # A traceback from a worker; a full disk must not hide the message itself.
            with contextlib.suppress(WorkbenchError):
                self.session.project.write_crash(error.hint)

    def crash(self, bug: Exception) -> None:
        """Keep the traceback of a bug and tell the designer where it is."""
        text = "".join(traceback.format_exception(bug))
        print(text, file=sys.stderr, flush=True)
        try:
            where = str(self.session.project.write_crash(text))
        except WorkbenchError:
            where = "the terminal"
        self.log(f"internal error: {bug!r}; see {where}")
        self.notify("Internal error", f"{bug!r}; the details are in {where}", color="red")

    def notify(self, title: str, body: str, *, color: Any = None) -> None:
        """A passing message in every tab."""
        for client in self.server.get_clients().values():
            client.add_notification(title, body, color=color, auto_close_seconds=NOTICE_S)

    def log(self, text: str) -> None:
        """Add a line to the log."""
        self.log_lines = [*self.log_lines[-199:], f"{time.strftime('%H:%M:%S')} {text}"]
        for panel in self.panels:
            panel.show("log", self.log_lines)
