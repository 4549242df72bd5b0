"""What a server logs of peers that come and go before they are let in."""

from __future__ import annotations

import asyncio
import logging
import socket
import struct
from typing import Any

import pytest
from websockets.exceptions import ConnectionClosedError

from ui.guard import Gate, guarded
from workbench.system.free_port import free_port

SENT = {
    "nothing": b"",
    "half a request": b"GET / HTTP/1.1\r\nHost: 127",
    "no HTTP": b"hello\r\n\r\n",
}


def logged(sent: bytes, log: pytest.LogCaptureFixture) -> list[str]:
    """Errors that a server logs of a peer that sends this and is gone."""
    port = free_port()

    async def handler(connection: Any) -> None:
        await connection.recv()

    async def visit() -> None:
        import websockets.asyncio.server as asyncio_server

        with guarded(Gate(port=port)):
            server = asyncio_server.serve(handler, "127.0.0.1", port)
        async with server:
            _, writer = await asyncio.open_connection("127.0.0.1", port)
            writer.write(sent)
            await writer.drain()
            # Cut off, as by a browser whose page is closed.
            at_once = struct.pack("ii", 1, 0)
            writer.get_extra_info("socket").setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, at_once)
            writer.close()
            await asyncio.sleep(1.0)

    with log.at_level(logging.ERROR):
        asyncio.run(visit())
    return [record.getMessage() for record in log.records if record.levelno >= logging.ERROR]


def test_a_peer_that_goes_leaves_no_traceback(caplog: pytest.LogCaptureFixture) -> None:
    """Gone before it sent a request, with half of one, or before its answer could be sent."""
    for name in ("nothing", "half a request"):
        assert logged(SENT[name], caplog) == [], name
    log = logging.getLogger("workbench.connections")
    fault = ConnectionClosedError(None, None)
    log.error("opening handshake failed", exc_info=fault)
    assert not caplog.records
    log.error("connection handler failed", exc_info=fault)
    assert len(caplog.records) == 1


def test_other_faults_are_logged(caplog: pytest.LogCaptureFixture) -> None:
    """What is no HTTP is told, and so is a page that could not be read."""
    assert logged(SENT["no HTTP"], caplog) == ["opening handshake failed"]
    for fault in (FileNotFoundError("page"), EOFError("packed page")):
        caplog.clear()
        logging.getLogger("workbench.connections").error("opening handshake failed", exc_info=fault)
        assert len(caplog.records) == 1
