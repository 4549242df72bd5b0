"""Which of several tabs edits: the first one; the others follow until they take over.

viser shares all widgets among the tabs of a server, so two people would pull at one slider. Here
one tab is the editor. A tab that follows sees everything and may look around; what it sends to
shared widgets is dropped by `ui.page.incoming`, and a note on top of its left dock says who edits
since when, and offers *Edit here*. When the editor's tab closes, the tab that comes next within
`RELOAD_S` takes its place (a reload), else the one that has followed longest. A tab that comes
while the editor's browser answers no ping takes its place too.

While another server holds the project no tab edits: all follow, are told where it is open, and may
take it over (`ui.tenancy`).

Left out: rights. Whoever may open the page may take over.
"""

from __future__ import annotations

import asyncio
import threading
import time
from collections.abc import Callable
from typing import Any

from ui.page.colours import AMBER
from ui.page.plain import plain
from ui.page.presence import Presence
from workbench.core.base.errors import WorkbenchError

RELOAD_S = 4.0
"""Time that the place of a tab that left is kept for its reload [s]."""
REMIND_S = 8.0
FIRST = -1000.0
"""Order of the note: above all else in the left dock."""


class Editor:
    """The one tab that edits, and the notes in all others."""

    def __init__(self, server: Any, *, reload_s: float = RELOAD_S) -> None:
        self.server = server
        self.reload_s = reload_s
        self.tab: int | None = None
        """Number of the tab that edits; None while there is none."""
        self.on_change: Callable[[str], None] = lambda text: None
        """Told when the editor changes, in words; without a lock of this object."""
        self.on_lost: list[Callable[[int], None]] = []
        """Told the number of a tab that is there still and edits no more."""
        self._leavings = 0
        """How often the tab that edits has left."""
        self._notes: dict[int, list[Any]] = {}
        self._presence = Presence(server)
        self._since = ""
        """When the tab began to edit, as a clock shows it."""
        self._asking: set[asyncio.Task[None]] = set()
        self._shut: tuple[str, Callable[[], None]] | None = None
        """Why no tab may edit, in Markdown, and what taking over begins with."""
        self._lock = threading.RLock()
        server.on_client_connect(self._came)
        server.on_client_disconnect(self._left)

    def edits(self, tab: int) -> bool:
        """Whether what this tab sends is taken."""
        return tab == self.tab

    @property
    def is_shut(self) -> bool:
        """Whether no tab may edit until one takes over."""
        return self._shut is not None

    def shut(self, why: str, on_open: Callable[[], None]) -> None:
        """Let no tab edit until one of them takes over.

        Args:
            why: What all tabs read, Markdown.
            on_open: Called before a tab takes over; what it raises, that tab is told.
        """
        with self._lock:
            self._shut = why, on_open
            clients = self.server.get_clients()
            before, self.tab = clients.get(self.tab), None
            for client in clients.values():
                self._unnote(client.client_id)
                self._note(client)
        if before is not None:
            for lost in self.on_lost:
                lost(before.client_id)

    def take_over(self, client: Any) -> None:
        """Make a tab the editor; the one before follows, and both are told."""
        if self._shut is not None:
            _, on_open = self._shut
            try:
                on_open()
            except WorkbenchError as error:
                _tell(client, "Not taken over", f"{error.message}: {error.hint}")
                return
        with self._lock:
            if self._shut is not None:
                self._shut = None
                for other in self.server.get_clients().values():
                    self._unnote(other.client_id)
                    if other is not client:
                        self._note(other)
            before = self._hand_over(client)
        self._tell_change(before)

    def _hand_over(self, client: Any) -> Any:
        """Make a tab the editor; returns the tab before, None where it is the same or gone."""
        before = self.server.get_clients().get(self.tab)
        self._appoint(client.client_id)
        self._unnote(client.client_id)
        if before is client:
            before = None
        if before is not None:
            self._note(before)
            _tell(before, "This tab follows now", "Another tab took over the editing.")
        _tell(client, "This tab edits now", "The others follow.")
        return before

    def _tell_change(self, before: Any) -> None:
        """Tell the others; the event loop waits for this object's lock, so never under that."""
        if before is not None:
            for lost in self.on_lost:
                lost(before.client_id)
        self.on_change("another tab edits now")

    def remind(self, tab: int) -> None:
        """Tell a tab that follows why nothing happened."""
        client = self.server.get_clients().get(tab)
        if client is not None:
            if self._shut is None:
                words = "Another tab edits. Click \u201cEdit here\u201d first."
            else:
                words = "Another workbench has this project. Click \u201cTake over\u201d first."
            _tell(client, "This tab follows", words)

    def _appoint(self, tab: int) -> None:
        """Let a tab edit; what the others read of it follows."""
        self.tab, self._since = tab, time.strftime("%H:%M")
        for number, (words, _) in self._notes.items():
            if number != tab:
                words.content = self._words()

    def _words(self) -> str:
        """Who edits, for the note of a tab that follows."""
        if self._shut is not None:
            return self._shut[0]
        who = "another tab" if self.tab is None else self._presence.words(self.tab)
        text = f"**This tab follows:** {plain(who)} edits since {self._since}."
        return f"<span style='color:{AMBER}'>{text}</span>"

    async def _came(self, client: Any) -> None:
        with self._lock:
            if self.tab is None and self._shut is None:
                self._appoint(client.client_id)
                return
            self._note(client)
            if self.tab is None:
                return
            # viser greets the tab when this returns: it must not wait for the other's answer.
            task = asyncio.get_running_loop().create_task(self._replace(self.tab, client))
            self._asking.add(task)
        task.add_done_callback(self._asking.discard)

    async def _replace(self, tab: int, client: Any) -> None:
        """Let a tab edit in the place of one whose browser is gone and whose connection stands."""
        if await self._presence.answers(tab):
            return
        with self._lock:
            # None: it has left meanwhile, and who came before that was noticed is its reload.
            free = self.tab in (tab, None) and self._shut is None
            if not free or client.client_id not in self.server.get_clients():
                return
            before = self._hand_over(client)
        self._presence.cut(tab)
        # Not here: the event loop must not wait for whoever is told.
        threading.Thread(target=self._tell_change, args=(before,), daemon=True).start()

    async def _left(self, client: Any) -> None:
        with self._lock:
            self._notes.pop(client.client_id, None)
            if self.tab != client.client_id:
                return
            self.tab = None
            self._leavings += 1
            timer = threading.Timer(self.reload_s, self._promote, (self._leavings,))
        timer.daemon = True
        timer.start()

    def _promote(self, leaving: int) -> None:
        """Let the tab that has followed longest edit, where none has come back.

        One that came back and left again is waited for anew: by another timer.
        """
        with self._lock:
            clients = self.server.get_clients()
            taken = self.tab is not None or self._shut is not None
            if taken or leaving != self._leavings or not clients:
                return
            self._hand_over(clients[min(clients)])
        self._tell_change(None)

    def _note(self, client: Any) -> None:
        gui = client.gui
        words = gui.add_markdown(self._words(), order=FIRST)
        hint = "What you change in this tab is not taken until then"
        label = "Edit here" if self._shut is None else "Take over"
        button = gui.add_button(label, hint=hint, order=FIRST + 1)
        button.on_click(lambda event: self.take_over(client))
        self._notes[client.client_id] = [words, button]

    def _unnote(self, tab: int) -> None:
        for handle in self._notes.pop(tab, []):
            handle.remove()


def _tell(client: Any, title: str, body: str) -> None:
    client.add_notification(title, body, auto_close_seconds=REMIND_S)
