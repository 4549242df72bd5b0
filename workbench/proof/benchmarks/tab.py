"""A tab without a browser: speaks viser's protocol over a WebSocket, for measurements and tests.

It keeps the newest properties of every widget and sends what a page would send. Left out: the
scene, whose messages are only counted.

Wire form (viser 1.1, `viser.infra`): to the server MessagePack of one message; from the server two
lengths of 8 bytes, MessagePack under zstd, then raw arrays.
"""

from __future__ import annotations

import contextlib
import threading
import time
from collections.abc import Callable
from importlib import metadata
from typing import Any

LOOK = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [50.0, 50.0, 50.0],
    "fov": 0.8,
    "near": 0.1,
    "far": 1000.0,
    "image_height": 600,
    "image_width": 500,
    "look_at": [0.0, 0.0, 10.0],
    "up_direction": [0.0, 0.0, 1.0],
}
"""The first message of a page; viser counts it as connected from then on."""


class Tab:
    """One connected page."""

    def __init__(self, url: str, *, headers: dict[str, str] | None = None) -> None:
        from websockets.sync.client import connect
        from websockets.typing import Subprotocol

        self.widgets: dict[str, dict[str, Any]] = {}
        """Newest properties by identifier."""
        self.commands: dict[str, dict[str, Any]] = {}
        self.seen: list[tuple[float, dict[str, Any]]] = []
        """Messages that are no part of the scene, with the time each came [s, monotonic]."""
        self.closed = False
        self._wake = threading.Condition()
        origin = {"Origin": url, **(headers or {})}
        self._socket = connect(
            url.replace("http", "ws", 1),
            additional_headers=origin,
            subprotocols=[Subprotocol(f"viser-v{metadata.version('viser')}")],
            max_size=None,
            compression=None,
            proxy=None,
        )
        threading.Thread(target=self._listen, daemon=True).start()
        self.send(LOOK)

    def __enter__(self) -> Tab:
        return self

    def __exit__(self, *raised: object) -> None:
        self.close()

    def close(self) -> None:
        """Leave."""
        self._socket.close()

    def answer(self, limit_s: float) -> None:
        """Have answered whatever pings the server sent by now: the close after a ping's answer
        is no answer.
        """
        assert self._socket.ping().wait(limit_s), "the server answers"

    def send(self, message: dict[str, Any]) -> None:
        """Send one message as it is."""
        import msgspec.msgpack

        self._socket.send(msgspec.msgpack.encode(message))

    def _listen(self) -> None:
        import websockets.exceptions

        with contextlib.suppress(websockets.exceptions.ConnectionClosed, OSError):
            while True:
                raw = self._socket.recv()
                if isinstance(raw, bytes):
                    self._take(raw)
        with self._wake:
            self.closed = True
            self._wake.notify_all()

    def _take(self, raw: bytes) -> None:
        import msgspec.msgpack
        import zstandard

        size = int.from_bytes(raw[8:16], "little")
        batch = msgspec.msgpack.decode(zstandard.ZstdDecompressor().decompress(raw[16 : 16 + size]))
        now = time.monotonic()
        with self._wake:
            for message in batch["messages"]:
                self._follow(now, message)
            self._wake.notify_all()

    def _follow(self, now: float, message: dict[str, Any]) -> None:
        kind, uuid = message["type"], message.get("uuid", "")
        if kind == "GuiUpdateMessage":
            self.widgets.setdefault(uuid, {}).update(message["updates"])
        elif kind == "RegisterCommandMessage":
            self.commands[uuid] = message["props"]
        elif kind == "GuiRemoveMessage":
            self.widgets.pop(uuid, None)
        elif kind.startswith("Gui") and "props" in message:
            value = {"value": message["value"]} if "value" in message else {}
            place = {"container": message.get("container_uuid", "")}
            self.widgets[uuid] = {"kind": kind, **place, **message["props"], **value}
        if "name" not in message:
            self.seen.append((now, message))

    def wait(self, condition: Callable[[], Any], seconds: float, what: str) -> Any:
        """What the condition gives once it is true.

        Raises:
            TimeoutError: If it does not come true in time.
        """
        deadline = time.monotonic() + seconds
        with self._wake:
            while not (found := condition()):
                left = deadline - time.monotonic()
                if left <= 0:
                    raise TimeoutError(f"after {seconds} s still not: {what}")
                self._wake.wait(min(left, 0.2))
        return found

    def find(self, label: str) -> str:
        """Identifier of the widget with a label, "" while there is none."""
        for uuid, props in list(self.widgets.items()):
            if props.get("label") == label:
                return uuid
        return ""

    def uuid(self, label: str, seconds: float = 20.0) -> str:
        """Identifier of the widget with a label, once it is there."""
        return self.wait(lambda: self.find(label), seconds, f"{label} is there")

    def value(self, label: str) -> Any:
        """Value of the widget with a label."""
        return self.widgets[self.uuid(label)]["value"]

    def set(self, label: str, value: Any) -> None:
        """Change a widget, as a person does: the page shows the value at once."""
        uuid = self.uuid(label)
        with self._wake:
            self.widgets[uuid]["value"] = value
        self.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}})

    def click(self, label: str) -> None:
        """Click a button."""
        updates = {"value": True}
        self.send({"type": "GuiUpdateMessage", "uuid": self.uuid(label), "updates": updates})

    def trigger(self, label: str) -> None:
        """Run a command of the palette."""
        found = self.wait(
            lambda: [u for u, props in self.commands.items() if props["label"] == label],
            20.0,
            f"the command {label} is there",
        )
        self.send({"type": "CommandTriggerMessage", "uuid": found[0]})

    def has_seen(self, words: str) -> bool:
        """Whether a notification, a text or a modal with these words has come."""
        texts = (
            str(message.get("props") or message.get("updates") or message)
            for _, message in list(self.seen)
        )
        return any(words in text for text in texts)
