"""Who edits after the tab that edited is gone: its reload, however closely one follows another."""

from __future__ import annotations

import asyncio
import threading
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import pytest

from ui.page.editor import Editor
from ui.page.presence import Presence

EDITOR, FOLLOWER, RELOADED = range(3)


class Server:
    """Tabs that come and leave, as viser tells of them."""

    def __init__(self) -> None:
        self.clients: dict[int, Any] = {}
        self.gone: set[int] = set()
        """Tabs whose browser answers no more."""
        self.told: list[Callable[[Any], Any]] = []

    def on_client_connect(self, act: Callable[[Any], Any]) -> None:
        self.told.append(act)

    on_client_disconnect = on_client_connect

    def get_clients(self) -> dict[int, Any]:
        return dict(self.clients)

    async def come(self, tab: int) -> None:
        """A tab opens; who it finds is asked by then, unless gone."""
        widget = SimpleNamespace(remove=lambda: None, on_click=lambda act: None, content="")
        gui = SimpleNamespace(
            add_markdown=lambda words, **look: widget, add_button=lambda words, **look: widget
        )
        self.clients[tab] = SimpleNamespace(
            client_id=tab, gui=gui, add_notification=lambda *words, **look: None
        )
        came, _ = self.told
        await came(self.clients[tab])
        if not self.gone:
            await asyncio.sleep(0)

    async def leave(self, tab: int) -> None:
        """A tab's connection ends."""
        _, left = self.told
        await left(self.clients.pop(tab))


class Timers:
    """Timers that ring when a test lets them."""

    def __init__(self) -> None:
        self.rings: list[Callable[[], None]] = []

    def __call__(
        self, seconds: float, act: Callable[..., None], given: tuple[Any, ...] = ()
    ) -> Any:
        self.rings.append(lambda: act(*given))
        return SimpleNamespace(start=lambda: None)


@pytest.fixture
def timers(monkeypatch: pytest.MonkeyPatch) -> Timers:
    """In place of those of the threads."""
    timers = Timers()
    monkeypatch.setattr(threading, "Timer", timers)
    return timers


@pytest.fixture
def server(monkeypatch: pytest.MonkeyPatch) -> Server:
    """One whose tabs answer unless they are gone."""
    server = Server()

    async def answers(presence: Presence, tab: int) -> bool:
        return tab not in server.gone

    monkeypatch.setattr(Presence, "answers", answers)
    return server


def test_the_place_is_kept_as_long_for_the_second_reload_as_for_the_first(
    server: Server, timers: Timers
) -> None:
    """The time of the first leaving ends while the tab is gone a second time: its place is kept,
    until the time of the second has ended too."""
    editor = Editor(server)

    async def reload_twice() -> None:
        await server.come(EDITOR)
        await server.come(FOLLOWER)
        await server.leave(EDITOR)
        await server.come(RELOADED)
        await server.leave(RELOADED)

    asyncio.run(reload_twice())
    first, second = timers.rings
    first()
    assert editor.tab is None
    second()
    assert editor.tab == FOLLOWER


def test_a_reload_that_comes_before_the_leaving_is_noticed_edits(
    server: Server, timers: Timers
) -> None:
    """The old connection stands when the new one comes, and ends while it is asked: the reload has
    the place, and the one that followed before does not get it later."""
    editor = Editor(server)

    async def overtake() -> None:
        await server.come(EDITOR)
        await server.come(FOLLOWER)
        assert editor.tab == EDITOR
        server.gone.add(EDITOR)
        await server.come(RELOADED)
        await server.leave(EDITOR)
        await asyncio.sleep(0)

    asyncio.run(overtake())
    assert editor.tab == RELOADED
    for ring in timers.rings:
        ring()
    assert editor.tab == RELOADED
