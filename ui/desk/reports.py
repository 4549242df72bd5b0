"""What the designer is told: refusals under their widget, a banner, notifications, the log."""

from __future__ import annotations

import contextlib
import queue
import sys
import time
import traceback
from collections import Counter
from collections.abc import Callable
from typing import Any

from ui.desk.session import Session
from ui.page.colours import RED
from ui.page.fields import Fields
from ui.page.plain import plain
from workbench.core.base.errors import WorkbenchError
from workbench.live.job_words import job_words

NOTICE_S = 15.0
LOG_LINES = 200
TRACEBACK = "Traceback"
"""How a hint begins that is for the crash file."""


def in_full(message: str, hint: str) -> str:
    """A message with its remedy as sentences; of a hint with a traceback what stands before it."""
    remedy = "" if hint.startswith(TRACEBACK) else hint.split("\n", 1)[0].strip()
    sentences = (f"{part[0].upper() if k else part[0]}{part[1:].rstrip('.')}."
                 for k, part in enumerate((message, remedy)) if part)  # fmt: skip
    return " ".join(sentences)


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
        self.places: dict[str, Any] = {}
        """Hidden markdown beside the button of each job."""
        self._last = ""
        """What the last line is about, where a newer one about it takes its place."""
        self.notices: list[Any] = []
        """Notifications of errors; they go with what they tell of."""
        self.lock = fields.lock
        self._crashes: Counter[str] = Counter()
        """How often each bug has come, by its traceback."""
        self._soon: queue.SimpleQueue[str] = queue.SimpleQueue()
        """Lines of threads that may not wait for the lock."""

    def beside(self, *jobs: str) -> None:
        """Make a place under the button just made, for what became of these jobs' requests."""
        handle = self.server.gui.add_markdown("", visible=False)
        self.places.update(dict.fromkeys(jobs, handle))

    def guarded(self, handler: Callable[[Any], None]) -> Callable[[Any], None]:
        """A widget callback whose errors reach the designer instead of the terminal only."""

        def call(event: Any) -> None:
            try:
                # viser calls from a pool of threads; the lock is re-entrant, because a value set
                # by a handler runs that widget's own handler at once.
                with self.lock:
                    handler(event)
            except WorkbenchError as error:
                with self.lock:
                    self.report(error)
            except Exception as bug:
                self.crash(bug)

        return call

    def received(
        self, read: Callable[[], Any], take: Callable[[Any], None]
    ) -> Callable[[Any], None]:
        """An upload's callback: `read` what came without the desk's lock, `take` it under it.

        Of a large file even the digest takes longer than other tabs should wait.
        """

        def call(event: Any) -> None:
            try:
                found = read()
            except Exception as error:
                self.tell(error)
                return
            self.guarded(lambda event: take(found))(event)

        return call

    def tell(self, error: Exception) -> None:
        """Show what went wrong in another thread than a widget's."""

        def again(event: Any) -> None:
            raise error

        self.guarded(again)(None)

    def report(self, error: WorkbenchError, *, edited: str = "", job: str = "") -> None:
        """Show an error at its field, and where the designer looks.

        Args:
            error: What went wrong.
            edited: Field that was just edited: a message about itself needs no banner.
            job: Request that failed: it is told beside its button, and in a notification, since
                the field may be on another page.
        """
        at_field = self.fields.complain(error)
        parts = (error.message, error.hint)
        # Before the remedy gets its capital: it may begin with the name of a field.
        words = in_full(*(self.fields.in_words(part, error.at) for part in parts))
        noted = bool(at_field) and at_field == edited
        # The last good value stays: nothing has failed, and a drag has many such values.
        self.log(f"note: {words}" if noted else words, once=at_field if noted else "")
        text = plain(words)
        if not noted:
            self._show_banner(text)
        if job in self.places:
            self.places[job].content = f"<span style='color:{RED}'>{text}</span>"
            self.places[job].visible = True
        if job or not at_field:
            what = job_words(job)
            title = f"{what[0].upper()}{what[1:]} failed" if job else "Not possible"
            self.notices += self.notify(title, words, color="red")
        self._crashes[error.hint] += 1
        if "\n" in error.hint and self._crashes[error.hint] == 1:
            # A traceback from a worker; a full disk must not hide the message itself.
            with contextlib.suppress(WorkbenchError):
                self.session.project.write_crash(error.hint)

    def remark(self, words: str) -> None:
        """Show words on top until the next edit, for example what became of the last session."""
        self._show_banner(plain(f"{words[0].upper()}{words[1:]}"))

    def _show_banner(self, text: str) -> None:
        self.banner.content = f"<span style='color:{RED}'>**{text}**</span>"
        self.banner.visible = True

    def settle(self, path: str = "") -> None:
        """Take back what was complained about: a good value has come, of the field `path`."""
        self.fields.settle(path)
        self.begin()

    def begin(self) -> None:
        """Take back what was said of the last request."""
        self.banner.visible = False
        for place in self.places.values():
            place.visible = False
        for notice in self.notices:
            notice.remove()
        self.notices.clear()

    def crash(self, bug: Exception) -> None:
        """Keep the traceback of a bug and tell the designer where it is; the same one once."""
        text = "".join(traceback.format_exception(bug))
        with self.lock:
            self._crashes[text] += 1
            count = self._crashes[text]
            if count == 1:
                self._keep_crash(bug, text)
            elif str(count).strip("0") == "1":
                # 10, 100, 1000: one that comes at each turn of the pump must not fill the log.
                self.log(f"internal error: {bug!r}, {count} times by now")

    def _keep_crash(self, bug: Exception, text: str) -> None:
        print(text, file=sys.stderr, flush=True)
        try:
            where = str(self.session.project.write_crash(text))
        except WorkbenchError:
            where = "the terminal"
        self.log(f"internal error: {bug!r}; see {where}")
        self.notify("Internal error", f"{bug!r}; the details are in {where}", color="red")

    def notify(self, title: str, body: str, *, color: Any = None) -> list[Any]:
        """A passing message in every tab."""
        return [
            client.add_notification(title, body, color=color, auto_close_seconds=NOTICE_S)
            for client in self.server.get_clients().values()
        ]

    def log(self, text: str, *, once: str = "") -> None:
        """Add a line to the log, from any thread that may wait for the desk's lock.

        Args:
            text: The line.
            once: What it is about, where it takes the place of a last line about the same.
        """
        with self.lock:
            kept = self.lines[:-1] if once and once == self._last else self.lines
            self.lines = [*kept[1 - LOG_LINES :], f"{time.strftime('%H:%M:%S')} {text}"]
            self._last = once
            self.on_log(self.lines)

    def log_soon(self, text: str) -> None:
        """Add a line when the pump turns: the event loop must not wait, or all tabs would."""
        self._soon.put(text)

    def turn(self) -> None:
        """Add the lines that wait; called by the pump."""
        while not self._soon.empty():
            self.log(self._soon.get())
