"""What may reach the shared widgets and the shared scene of a server, decided in one place.

viser hands every message of every tab to the handlers of its server. This stands before them: a tab
that follows reaches none of them, except widgets that only open something in the tab itself; nobody
opens viser's tunnel to the outside; a file is refused by the size its first message tells, and
its parts are dropped as they come instead of being kept. Widgets of a tab of its own (`client.gui`)
are viser's business and pass.

viser (1.1) has no hook here: the server's `_handle_incoming_message` is replaced.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Protocol

from viser import _messages as messages

from workbench.system.uploads import MOST_BYTES, own_name

NEVER = (messages.ShareUrlRequest, messages.ShareUrlDisconnect)
"""The tunnel makes the workbench public; no tab may ask for it."""
TRANSFERS = 4
"""Files under way at once."""
PART_BYTES = 512 * 1024
"""Size of the parts in which viser's page sends a file."""
REMIND_S = 5.0
"""Shortest time between two reminders that a tab follows [s]."""


class Roles(Protocol):
    """Who edits."""

    def edits(self, tab: int) -> bool:
        """Whether what a tab sends is taken."""
        ...

    def remind(self, tab: int) -> None:
        """Tell a tab that it follows."""
        ...


@dataclass(kw_only=True, slots=True)
class _Transfer:
    """A file on its way."""

    tab: int
    left_bytes: int
    start: Any
    """Its first message, by which its end is told."""


class Incoming:
    """Stands before the handlers of one server."""

    def __init__(self, server: Any, roles: Roles) -> None:
        self.server = server
        self.roles = roles
        self.on_refused: Callable[[str], None] = lambda text: None
        """Told of files that were not taken."""
        self._open: set[str] = set()
        self._transfers: dict[str, _Transfer] = {}
        self._reminded: dict[int, float] = {}
        self._socket = server._websock_server
        self._pass_on = self._socket._handle_incoming_message
        self._socket._handle_incoming_message = self._decide
        server.on_client_disconnect(self._forget)

    def open_to_all(self, handle: Any) -> Any:
        """Let tabs that follow use a button or a command, which changes nothing others see."""
        self._open.add(handle._impl.uuid)
        return handle

    async def _decide(self, tab: int, message: Any) -> None:
        if isinstance(message, NEVER) or type(message) not in self._socket._incoming_handlers:
            # The latter, for example where a tab looks from, is told to the tab's own handlers.
            return
        if not self.roles.edits(tab) and getattr(message, "uuid", "") not in self._open:
            self._refuse(tab, message)
            return
        if isinstance(message, messages.GuiUpdateMessage) and set(message.updates) != {"value"}:
            # A page changes nothing else; viser would set any attribute of the widget.
            return
        if isinstance(message, messages.FileTransferStartUpload):
            if not self._begins(tab, message):
                return
        elif isinstance(message, messages.FileTransferPart) and not self._continues(tab, message):
            return
        await self._pass_on(tab, message)

    def _refuse(self, tab: int, message: Any) -> None:
        """Put back what a tab that follows has moved, and tell it why."""
        if isinstance(message, messages.GuiUpdateMessage):
            self._put_back(tab, message.uuid)
        elif isinstance(message, messages.TransformControlsUpdateMessage):
            self._put_handle_back(tab, message.name)
        elif isinstance(message, messages.FileTransferStartUpload):
            self._end_upload(tab, message)
        elif isinstance(message, messages.FileTransferPart):
            transfer = self._transfers.get(message.transfer_uuid)
            if transfer is not None and transfer.tab == tab:
                self._drop(message.transfer_uuid)
        if self._escapes(message):
            # The key also closes what is the tab's own.
            return
        now = time.monotonic()
        if now - self._reminded.get(tab, -REMIND_S) >= REMIND_S:
            self._reminded[tab] = now
            self.roles.remind(tab)

    def _escapes(self, message: Any) -> bool:
        command = self.server.gui._command_handle_from_uuid.get(getattr(message, "uuid", ""))
        return command is not None and command.hotkey == "escape"

    def _send(self, tab: int, *answers: Any) -> None:
        client = self.server.get_clients().get(tab)
        if client is not None:
            for answer in answers:
                client._websock_connection.queue_message(answer)

    def _put_back(self, tab: int, uuid: str) -> None:
        handle = self.server.gui._gui_input_handle_from_uuid.get(uuid)
        if handle is not None and not handle._impl.is_button:
            value = {"value": handle._impl.value}
            self._send(tab, messages.GuiUpdateMessage(uuid=uuid, updates=value))

    def _put_handle_back(self, tab: int, name: str) -> None:
        handle = self.server.scene._handle_from_node_name.get(name)
        if handle is not None:
            wxyz, position = tuple(handle.wxyz), tuple(handle.position)
            self._send(
                tab,
                messages.SetOrientationMessage(name=name, wxyz=wxyz),
                messages.SetPositionMessage(name=name, position=position),
            )

    def _begins(self, tab: int, message: Any) -> bool:
        """Whether a file may come; the first message of it tells its size."""
        for uuid in [u for u, t in self._transfers.items() if not self.roles.edits(t.tab)]:
            # Of a tab that lost the editing: it must not keep its slot.
            self._drop(uuid)
        name, size = own_name(message.filename), message.size_bytes
        slots = -(-size // PART_BYTES)
        if not (0 <= size <= MOST_BYTES and slots <= message.part_count <= slots + 1):
            why = (
                f"{name} has {size / 1e6:.1f} MB, the browser takes {MOST_BYTES / 1e6:g} MB. "
                "Reduce it, or give it to the command line."
            )
        elif len(self._transfers) >= TRANSFERS:
            why = f"{name} has to wait: {TRANSFERS} files are on their way"
        else:
            if size > 0:
                self._transfers[message.transfer_uuid] = _Transfer(
                    tab=tab, left_bytes=size, start=message
                )
            return True
        self._end_upload(tab, message)
        client = self.server.get_clients().get(tab)
        if client is not None:
            client.add_notification("Not uploaded", why, color="red", auto_close_seconds=15.0)
        self.on_refused(why)
        return False

    def _continues(self, tab: int, message: Any) -> bool:
        """Whether a part belongs to a file that was let in, and is no more than it promised."""
        transfer = self._transfers.get(message.transfer_uuid)
        if transfer is None or transfer.tab != tab:
            return False
        transfer.left_bytes -= len(message.content)
        if transfer.left_bytes < 0:
            del self._transfers[message.transfer_uuid]
            self.server.gui._current_file_upload_states.pop(message.transfer_uuid, None)
            return False
        if transfer.left_bytes == 0:
            del self._transfers[message.transfer_uuid]
        return True

    def _drop(self, uuid: str) -> None:
        """Forget a file on its way, and free the button of its page."""
        transfer = self._transfers.pop(uuid)
        self.server.gui._current_file_upload_states.pop(uuid, None)
        self._end_upload(transfer.tab, transfer.start)

    def _end_upload(self, tab: int, message: Any) -> None:
        """Free the page's button, which waits for the file, and take its progress away."""
        done = messages.FileTransferPartAck(
            source_component_uuid=message.source_component_uuid,
            transfer_uuid=message.transfer_uuid,
            transferred_bytes=message.size_bytes,
            total_bytes=message.size_bytes,
        )
        shown = f"upload-{message.transfer_uuid}"
        self._send(tab, done, messages.RemoveNotificationMessage(uuid=shown))

    async def _forget(self, client: Any) -> None:
        self._reminded.pop(client.client_id, None)
        for uuid in [u for u, t in self._transfers.items() if t.tab == client.client_id]:
            del self._transfers[uuid]
