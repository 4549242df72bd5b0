"""Which stored results are on show, and showing those of the state as it stands."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import Any

from ui.desk.session import Session
from ui.desk.signal import Signal
from ui.page.background_thread import BackgroundThread
from workbench.core.base.errors import DamagedError
from workbench.core.result.results import Solid
from workbench.pipeline.stage import Outcome
from workbench.planning.stage_table import STAGES


class ShownResults:
    """Results of one desk."""

    def __init__(self, session: Session, background: BackgroundThread) -> None:
        self._session, self._background = session, background
        self.on_body: Signal[[Solid]] = Signal()
        """Another body is to be shown: what was shown of the old one has gone."""
        self.on_notices: Signal[[dict[str, str]]] = Signal()
        """What builder and mesher had to change, by stage."""
        self.on_result: Signal[[str, Any]] = Signal()
        """A stage's result that is to be shown."""
        self._keys: dict[str, str] = {}
        """Key of what is on show, by stage."""
        self._fetched: dict[str, str] = {}
        """Key of what is being read in the background, by stage."""
        self._notices: dict[str, str] = {}
        """What builder and mesher had to change."""

    def current(self, stage: str) -> bool:
        """Whether what is shown of a stage belongs to the state as it stands."""
        call = self._session.calls().get(stage)
        return call is not None and self._keys.get(stage) == call.key

    def show_stored(self) -> None:
        """Show every result that is stored for the state as it stands."""
        session = self._session
        for stage in (name for name, record in STAGES.items() if record.shown):
            # Asked anew each time: showing a body may move the target, and with it later keys.
            call = session.calls().get(stage)
            if call is not None and session.store.has(stage, call.key):
                self._show(stage, call.key)

    def stage_done(self, outcome: Outcome) -> None:
        """Show a result that has just been computed, if the state still asks for it."""
        # What could not be read before has been computed anew.
        self._fetched.pop(outcome.stage, None)
        calls = self._session.calls()
        call = calls.get(outcome.stage) if STAGES[outcome.stage].shown else None
        if call is not None and call.key == outcome.key:
            self._show(outcome.stage, outcome.key)
        if STAGES[outcome.stage].parts:
            # Nobody tells that its parts are there, of which an image has the maps.
            self.show_stored()

    def forget(self, *stages: str) -> None:
        """Show the stored results of these stages again when the state is next followed."""
        for stage in stages:
            self._keys.pop(stage, None)

    def forget_all(self) -> None:
        """Nothing that is on show belongs to the state any more."""
        self._keys.clear()

    def _show(self, stage: str, key: str) -> None:
        if self._keys.get(stage) == key:
            return
        if not STAGES[stage].heavy:
            # Damaged since it was looked into: the store has said so, and it is not there any more.
            with contextlib.suppress(DamagedError):
                self._put(stage, key, self._session.store.load(stage, key))
        elif self._fetched.get(stage) != key:
            self.fetch(stage, key, lambda result: self._arrived(stage, key, result))

    def fetch(self, stage: str, key: str, take: Callable[[Any], None]) -> None:
        """Read a stored result in the background; a newer request of the stage takes its place."""
        self._fetched[stage] = key
        store = self._session.store

        def arrived(result: Any) -> None:
            self._fetched.pop(stage, None)
            take(result)

        self._background.ask(f"read {stage}", (store.load(stage, key) for _ in range(1)), arrived)

    def _arrived(self, stage: str, key: str, result: Any) -> None:
        """Show what has been read, unless the state asks for another by now."""
        call = self._session.calls().get(stage)
        if call is not None and call.key == key != self._keys.get(stage):
            self._put(stage, key, result)

    def _put(self, stage: str, key: str, result: Any) -> None:
        if stage == "build":
            # Another body: what was shown of the old one goes.
            self._keys = {stage: key}
            self._notices.clear()
            self.on_body(result)
        self._keys[stage] = key
        if stage in ("build", "mesh"):
            self._notices[stage] = result.notice
            self.on_notices(self._notices)
        self.on_result(stage, result)
