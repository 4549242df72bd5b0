"""Keeps the design: a moment after the last edit, in a thread of its own, again where that fails.

A disk may be slow, full or read-only. The state is a value, so that it is written without the lock
that the tabs wait for; a failure is told once, stays marked above the tabs, and is tried again
until the disk takes it. The file on disk is the last one that could be written whole.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any

from ui.desk.reports import Reports
from ui.desk.session import Session
from ui.page.colours import RED
from ui.page.plain import plain
from workbench.core.base.errors import WorkbenchError

QUIET_S = 0.5
"""Time after an edit before the design is written [s]."""
RETRY_S = 3.0
"""Time after a failure before it is tried again [s]."""


class Saving:
    """Writes the state of one session."""

    def __init__(
        self,
        session: Session,
        reports: Reports,
        mark: Any,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self.session = session
        self.reports = reports
        self.mark = mark
        """Hidden markdown that shows that the design is not saved."""
        self._clock = clock
        self._due: float | None = None
        self._writer = ThreadPoolExecutor(1, thread_name_prefix="autosave")
        self._running: Future[None] | None = None
        self.failed = False

    def edited(self) -> None:
        """The state has changed: it is written once edits pause."""
        self._due = self._clock() + QUIET_S

    def turn(self) -> None:
        """Begin to write what is due, and tell how the last writing ended."""
        if self._running is not None and self._running.done():
            ended, self._running = self._running, None
            self._tell(ended)
        if self._due is not None and self._running is None and self._clock() >= self._due:
            self._due = None
            self._running = self._writer.submit(self.session.autosave, self.session.state)

    def _tell(self, ended: Future[None]) -> None:
        try:
            ended.result()
        except WorkbenchError as error:
            if self._due is None:
                self._due = self._clock() + RETRY_S
            if not self.failed:
                self.failed = True
                self.reports.report(error)
            words = plain(f"{error.message}. The workbench goes on and tries again.")
            self.mark.content = f"<span style='color:{RED}'>**Not saved:** {words}</span>"
            self.mark.visible = True
        else:
            if self.failed:
                self.failed = False
                self.mark.visible = False
                self.reports.log("the design is saved again")
                self.reports.notify("Saved", "The design is saved again.", color="green")
