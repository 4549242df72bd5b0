"""The state behind the browser, without a browser: design, press, undo, staleness, autosave.

Widgets call `change`; a refused value raises and leaves everything as it was. Edits of one field in
quick succession (a drag) are one step of undo.
"""

from __future__ import annotations

import dataclasses
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from workbench.core.base.errors import DamagedError, WorkbenchError
from workbench.core.design.design import SensorDesign
from workbench.core.design.optics import Optics
from workbench.core.press.indenter import Indenter
from workbench.core.press.press_case import PressCase
from workbench.edit.item_fields import with_field
from workbench.live.requests import Request
from workbench.pipeline.stage import Call
from workbench.planning.planned import planned
from workbench.project.design_toml import check_design, design_from_toml
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State, case_table, fresh_state, read_state
from workbench.system.names import AUTOSAVE

COALESCE_S = 0.7
"""Edits of the same field closer than this are one step of undo [s]."""
UNDO_LIMIT = 200
DEFAULT_DESIGN = "geltip"


class Session:
    """One designer's work on one design."""

    def __init__(self, project: Project, clock: Callable[[], float] = time.monotonic) -> None:
        self.project = project
        self.store = project.store
        self.notice = ""
        """What happened while loading, to be shown once."""
        self.may_write: Callable[[], bool] = lambda: True
        """Whether the project is this server's to write: another may have taken it."""
        self._clock = clock
        self._saving = threading.Lock()
        self._past: list[State] = []
        self._future: list[State] = []
        self._last_edit = ("", -1e9)
        self._held = ""
        """The field whose handle a hand holds: all of its edits are one step of undo."""
        self.state = fresh_state(load_design(DEFAULT_DESIGN))

    @property
    def design(self) -> SensorDesign:
        """The design as it stands."""
        return self.state.design

    @property
    def case(self) -> PressCase:
        """The press as it stands."""
        return self.state.case

    def origin(self) -> tuple[str, str]:
        """What kind of sensor the design is: its family, and the file of its body."""
        body = self.design.body
        return self.design.family, body.outer.sha256 if body is not None else ""

    def open(self, name: str | None, *, unit: str = "auto") -> None:
        """Start from a named design, else from where the last session stopped; nothing to undo.

        Raises:
            DesignError: If the named design does not exist; a broken autosave only leaves a notice.
        """
        self._past.clear()
        self._future.clear()
        if name is not None:
            self.state = fresh_state(load_design(name, unit=unit, project=self.project))
            return
        path = self.project.design_path(AUTOSAVE)
        if path.exists():
            self._resume(path)

    def _resume(self, path: Path) -> None:
        """Take the autosaved design and its press; without the press where only that is broken."""
        try:
            text = path.read_text(encoding="utf-8")
            roots = (self.project.folder,)
            self.state = fresh_state(design_from_toml(text, source=str(path), roots=roots))
        except (WorkbenchError, OSError, UnicodeDecodeError) as error:
            self.notice = f"the last session could not be read: {error}{self._aside()}"
            return
        try:
            self.state = read_state(text, self.project, source=str(path))
        except WorkbenchError as error:
            words = "the press of the last session is the default one again"
            self.notice = f"{words}: {error}{self._aside()}"

    def _aside(self) -> str:
        """Keep an autosave that cannot be read from being written over; in words."""
        try:
            kept = self.project.keep_aside(AUTOSAVE)
        except WorkbenchError as error:
            return f"; {error.message}"
        return f"; the file is kept as {kept.name}"

    def change(self, dotted: str, value: Any) -> None:
        """Set one field, for example `design.optics.lamps[1].power` or `case.press.depth_mm`.

        Raises:
            DesignError: If the value is refused; the state is as before.
        """
        root, _, rest = dotted.partition(".")
        if root == "design":
            design = with_field(self.design, rest, value)
            check_design(design)
            self._commit(dataclasses.replace(self.state, design=design), dotted)
        else:
            group, _, name = rest.partition(".")
            part = dataclasses.replace(getattr(self.case, group), **{name: value})
            case = dataclasses.replace(self.case, **{group: part})
            self._commit(dataclasses.replace(self.state, case=case), dotted)

    def change_optics(self, optics: Optics) -> None:
        """Take all lights and cameras of a design at once."""
        design = self.design.replace("optics", optics)
        self._commit(dataclasses.replace(self.state, design=design), "design.optics")

    def change_design(self, design: SensorDesign) -> None:
        """Take several fields of the design as one step of undo.

        Raises:
            DesignError: If the design is refused; the state is as before.
        """
        check_design(design)
        self._commit(dataclasses.replace(self.state, design=design), "design")

    def change_press(self, **values: Any) -> None:
        """Set several fields of the press as one step of undo.

        Raises:
            DesignError: If a value is refused; the state is as before.
        """
        press = dataclasses.replace(self.case.press, **values)
        case = dataclasses.replace(self.case, press=press)
        self._commit(dataclasses.replace(self.state, case=case), "case.press")

    def amend(self, dotted: str, value: Any) -> None:
        """Change a press field as part of the last edit: undo takes both back together."""
        state, past, future, last = self.state, self._past, list(self._future), self._last_edit
        self.change(dotted, value)
        if self.state is not state:
            # The edit before stays the last one, or a drag amended on its way would fall apart.
            self._past, self._future, self._last_edit = past, future, last

    def replace_indenter(self, indenter: Indenter) -> None:
        """Take another object."""
        case = dataclasses.replace(self.case, indenter=indenter)
        self._commit(dataclasses.replace(self.state, case=case), "case.indenter")

    def replace_state(self, state: State) -> None:
        """Take a whole other design and press, for example an uploaded file or a variant."""
        check_design(state.design)
        self._commit(state, "state")

    def replace_design(self, design: SensorDesign) -> None:
        """Take a whole other design, for example a preset; the press stays, aimed anew."""
        self.replace_state(fresh_state(design, self.case))

    def hold(self, field: str) -> None:
        """A hand takes hold of a field's handle, or lets go: ""; a drag is one step of undo."""
        if field != self._held:
            self._held, self._last_edit = field, ("", -1e9)

    def _commit(self, state: State, field: str) -> None:
        if state == self.state:
            return
        now = self._clock()
        name, when = self._last_edit
        if field != self._held:
            self._held = ""
        if name != field or (now - when > COALESCE_S and not self._held):
            self._past = [*self._past[-UNDO_LIMIT:], self.state]
        self._last_edit = (field, now)
        self._future.clear()
        self.state = state

    def undo(self) -> bool:
        """One step back; False when there is none."""
        return self._step(self._past, self._future)

    def redo(self) -> bool:
        """One step forward again; False when there is none."""
        return self._step(self._future, self._past)

    def _step(self, source: list[State], target: list[State]) -> bool:
        if not source:
            return False
        target.append(self.state)
        self.state = source.pop()
        self._last_edit = ("", -1e9)
        return True

    def calls(self) -> dict[str, Call]:
        """Calls and keys of the state as it stands."""
        return planned(self.state.design, self.state.case)

    def fresh(self) -> dict[str, bool]:
        """Whether each stage's result is stored for the state; stages it has not are left out."""
        calls = self.calls()
        return {name: self.store.has(name, calls[name].key) for name in calls}

    def asks_now(self, request: Request, failed: str) -> bool:
        """Whether the stage of a request that failed is a stage of the state as it stands."""
        if request.preview is not None and request.case.indenter != self.case.indenter:
            return False
        if not failed:
            return request.design == self.design
        now = self.calls().get(failed)
        return now is not None and now.key == planned(request.design, request.case)[failed].key

    def result(self, stage: str) -> Any:
        """The stored result of a stage for the state as it stands; None where none is readable."""
        call = self.calls().get(stage)
        if call is None or not self.store.has(stage, call.key):
            return None
        try:
            return self.store.load(stage, call.key)
        except DamagedError:
            return None

    def autosave(self, state: State | None = None) -> None:
        """Keep a state, by default the one that stands, for the next start.

        Nothing is written while another server has the project.

        Raises:
            StoreError: If the project folder cannot be written; the file there stays.
        """
        with self._saving:
            if not self.may_write():
                return
            kept = self.state if state is None else state
            press_case = case_table(kept.case, self.project)
            self.project.save_design(AUTOSAVE, kept.design, press_case=press_case)
