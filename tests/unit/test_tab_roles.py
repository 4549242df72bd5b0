"""What a tab leaves behind when another takes the editing over: galleries, drags, uploads."""

from __future__ import annotations

import asyncio
import contextlib
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from viser import _messages as messages

from ui.page.editor import Editor
from ui.page.gallery import Card, Galleries
from ui.page.incoming import PART_BYTES, TRANSFERS, Incoming
from ui.scene.gizmo import Gizmo

FIRST, SECOND = 1, 2


class Window:
    """A modal that remembers whether it is closed."""

    def __init__(self) -> None:
        self.closed = False

    def __enter__(self) -> Window:
        return self

    def __exit__(self, *raised: object) -> None:
        pass

    def close(self) -> None:
        assert not self.closed
        self.closed = True


class Client:
    """A tab: its window and the row of buttons in it."""

    def __init__(self, number: int) -> None:
        self.client_id = number
        self.windows: list[Window] = []
        self.rows: list[Any] = []
        self.sent: list[Any] = []
        self.told: list[str] = []
        self.gui: Any = SimpleNamespace(
            add_modal=self._modal,
            add_html=lambda content: None,
            add_button_group=self._row,
            add_command=lambda name, **key: SimpleNamespace(
                on_trigger=lambda act: None, remove=lambda: None
            ),
            add_markdown=lambda content, **look: SimpleNamespace(remove=lambda: None),
            add_button=lambda *words, **look: SimpleNamespace(
                on_click=lambda act: None, remove=lambda: None
            ),
        )
        self._websock_connection = SimpleNamespace(queue_message=self.sent.append)

    def _modal(self, title: str) -> Window:
        self.windows.append(Window())
        return self.windows[-1]

    def _row(self, label: str, options: tuple[str, ...]) -> Any:
        self.rows.append(SimpleNamespace(on_click=lambda act: setattr(self, "click", act)))
        return self.rows[-1]

    def add_notification(self, title: str, body: str, **look: Any) -> None:
        self.told.append(title)

    def choose(self, name: str) -> None:
        """Click a card."""
        self.click: Any
        self.click(SimpleNamespace(target=SimpleNamespace(value=name)))


class Server:
    """Two tabs, and viser's handlers of messages."""

    def __init__(self) -> None:
        self.clients = {number: Client(number) for number in (FIRST, SECOND)}
        self.passed: list[Any] = []
        self.gui = SimpleNamespace(_current_file_upload_states={}, _command_handle_from_uuid={})
        kinds = (messages.FileTransferStartUpload, messages.FileTransferPart)
        self._websock_server = SimpleNamespace(
            _handle_incoming_message=self._pass, _incoming_handlers=dict.fromkeys(kinds)
        )

    async def _pass(self, tab: int, message: Any) -> None:
        self.passed.append(message)

    def on_client_connect(self, act: Any) -> None:
        pass

    on_client_disconnect = on_client_connect

    def get_clients(self) -> dict[int, Client]:
        return self.clients


@pytest.fixture
def server() -> Server:
    return Server()


@pytest.fixture
def editor(server: Server) -> Editor:
    """The first of two tabs edits."""
    editor = Editor(server)
    editor.tab = FIRST
    return editor


def test_a_gallery_closes_when_another_tab_takes_over(server: Server, editor: Editor) -> None:
    """The window goes with the editing; a choice on its way is refused, and told why."""
    galleries, chosen = Galleries(server, editor), []
    first = server.clients[FIRST]
    galleries.show(first, "Start from", [Card(name="geltip")], chosen.append)
    editor.take_over(server.clients[SECOND])
    assert first.windows[0].closed
    first.choose("geltip")
    assert chosen == []
    assert "This tab follows" in first.told


def test_the_editor_chooses_once(server: Server, editor: Editor) -> None:
    """A second gallery takes the place of the first; the choice closes it."""
    galleries, chosen = Galleries(server, editor), []
    first = server.clients[FIRST]
    for _ in range(2):
        galleries.show(first, "Start from", [Card(name="geltip")], chosen.append)
    assert [window.closed for window in first.windows] == [True, False]
    first.choose("geltip")
    assert chosen == ["geltip"]
    assert first.windows[1].closed


class Handle:
    """The transform controls of a gizmo."""

    def __init__(self) -> None:
        self.position, self.wxyz, self.visible = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0), True

    def on_update(self, act: Any) -> Any:
        self.act = act
        return act

    def drag(self, tab: int, phase: str) -> None:
        asyncio.run(self.act(SimpleNamespace(phase=phase, client_id=tab)))


@pytest.fixture
def handle() -> Handle:
    return Handle()


@pytest.fixture
def gizmo(editor: Editor, handle: Handle) -> Gizmo:
    api = SimpleNamespace(add_transform_controls=lambda *words, **look: handle)
    return Gizmo(api, lambda place, turn: None, edits=editor.edits)


@contextlib.contextmanager
def dragged(handle: Handle, gizmo: Gizmo) -> Iterator[None]:
    """A drag of the first tab whose end never comes."""
    handle.drag(FIRST, "start")
    gizmo.place(np.ones(3))
    assert handle.position == (0.0, 0.0, 0.0)
    yield
    gizmo.place(np.ones(3))
    assert handle.position == (1.0, 1.0, 1.0)


def test_a_handle_is_let_go_by_who_edits_no_more(
    server: Server, editor: Editor, handle: Handle, gizmo: Gizmo
) -> None:
    """After a take-over it follows again, also when the first tab has the editing back."""
    with dragged(handle, gizmo):
        editor.take_over(server.clients[SECOND])
        gizmo.turn()
        editor.take_over(server.clients[FIRST])


def test_a_handle_is_let_go_when_its_tab_closes(
    editor: Editor, handle: Handle, gizmo: Gizmo
) -> None:
    """Nobody edits: it follows."""
    with dragged(handle, gizmo):
        editor.tab = None


def test_a_hidden_handle_is_held_by_nobody(handle: Handle, gizmo: Gizmo) -> None:
    """Shown again it stands at its thing."""
    with dragged(handle, gizmo):
        gizmo.show(False)
        gizmo.show(True)


def begin(name: str) -> messages.FileTransferStartUpload:
    """The first message of a file of two parts."""
    return messages.FileTransferStartUpload(
        source_component_uuid="button",
        transfer_uuid=name,
        filename=f"{name}.toml",
        mime_type="",
        part_count=2,
        size_bytes=2 * PART_BYTES,
    )


def part(name: str) -> messages.FileTransferPart:
    return messages.FileTransferPart(
        source_component_uuid="button", transfer_uuid=name, part_index=0, content=b"1"
    )


def test_files_of_a_tab_that_edits_no_more_give_their_slots_back(
    server: Server, editor: Editor
) -> None:
    """Four begun by the first tab: the second, taking over, uploads; parts that come are ended."""
    incoming = Incoming(server, editor)

    def send(tab: int, message: Any) -> None:
        asyncio.run(incoming._decide(tab, message))  # pyright: ignore[reportPrivateUsage]

    for number in range(TRANSFERS):
        send(FIRST, begin(f"old{number}"))
    editor.take_over(server.clients[SECOND])
    send(FIRST, part("old0"))
    ended = [m for m in server.clients[FIRST].sent if isinstance(m, messages.FileTransferPartAck)]
    assert [message.transfer_uuid for message in ended] == ["old0"]
    for number in range(TRANSFERS):
        send(SECOND, begin(f"new{number}"))
    assert [m.transfer_uuid for m in server.passed[TRANSFERS:]] == [
        f"new{number}" for number in range(TRANSFERS)
    ]
    assert "Not uploaded" not in server.clients[SECOND].told
