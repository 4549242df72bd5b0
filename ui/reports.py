"""What the designer is told: refusals under their widget, a banner, notifications, the log."""

from __future__ import annotations

import contextlib
import html
import sys
import threading
import time
import traceback
from collections.abc import Callable
from typing import Any

from ui.panels.fields import Fields
from ui.session import Session
from workbench.core.errors import WorkbenchError

NOTICE_S = 15.0
LOG_LINES = 200
RED = "#e5484d"


class Reports:
    """Messages of one desk."""

    def __init__(self, server: Any, session: Session, fields: Fields) -> None:
        self.server = server
        self.session = session
        self.fields = fields
        self.lines: list[str] = []
        self.on_log: Callable[[list[str]], None] = lambda lines: None
        """Set by the desk: shows the lines."""
        self.banner: Any = None
        """Set by the header: stays until the next edit."""
        self.lock = threading.RLock()

    def guarded(self, handler: Callable[[Any], None]) -> Callable[[Any], None]:
        """A widget callback whose errors reach the designer instead of the terminal only."""

        def call(event: Any) -> None:
            try:
                # viser calls from a pool of threads; the lock is re-entrant, because a value set
                # by a handler runs that widget's own handler at once.
                with self.lock:
                    handler(event)
            except WorkbenchError as error:
                self.report(error)
            except Exception as bug:
                self.crash(bug)

        return call

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
            self.banner.content = f"<span style='color:{RED}'>**{text}**</span>"
            self.banner.visible = True
        if not at_field:
            self.notify("Not possible", f"{words}.{hint}", color="red")
        if "\n" in error.hint:
            # A traceback from a worker; a full disk must not hide the message itself.
            with contextlib.suppress(WorkbenchError):
                self.session.project.write_crash(error.hint)

    def settle(self) -> None:
        """Take back what was complained about: a good value has come."""
        self.fields.clear_complaints()
        self.banner.visible = False

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
        self.lines = [*self.lines[1 - LOG_LINES :], f"{time.strftime('%H:%M:%S')} {text}"]
        self.on_log(self.lines)
