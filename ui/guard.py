"""Who may talk to the workbench: Host and Origin checks, a token, and `/healthz`.

A server on loopback is still reachable from any web page the user has open; without these checks
such a page could drive the workbench. viser calls `websockets.asyncio.server.serve` itself, so
that one call is wrapped while the server is being built.
"""

from __future__ import annotations

import contextlib
import ipaddress
import json
import logging
import secrets
import urllib.parse
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
COOKIE = "workbench_token"
"""Begin of the cookie's name; the port follows, since browsers share cookies among ports."""
HEALTH_PATH = "/healthz"
MOST_MESSAGE_BYTES = 16 * 2**20
"""Of one message: a file comes in parts of half a megabyte, an image of the view in one."""
PING_S, PONG_S = 5.0, 15.0
"""Time between two questions whether a tab is there, and what it has to answer [s]: a connection
that was cut without a word would hold its place for minutes."""
POLICY = (
    "default-src 'none'; base-uri 'none'; object-src 'none'; form-action 'none'; "
    "frame-ancestors 'self'; manifest-src 'self'; "
    "script-src 'self' 'unsafe-inline' 'wasm-unsafe-eval' blob:; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; font-src 'self' data:; img-src 'self' data: blob:; "
    "connect-src 'self' data: blob:"
)
"""What the page may load and reach: itself alone. viser's page is one file with scripts in it, that
unpacks its images and workers from data and blobs."""
SAFE_HEADERS = {
    "Content-Security-Policy": POLICY,
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "X-Frame-Options": "SAMEORIGIN",
}
"""Of every answer: no page of another site shows the workbench in a frame, or learns the token."""


@dataclass(kw_only=True)
class Gate:
    """The rules of one server."""

    port: int
    hosts: tuple[str, ...] = LOOPBACK
    token: str | None = None
    """Needed in a cookie, or once in the link; None on loopback."""
    health: Callable[[], dict[str, Any]] = field(default=lambda: {"ok": True})

    def decide(self, path: str, headers: Any) -> tuple[int, dict[str, str], bytes] | None:
        """Status, headers and body of a refusal or own page; None lets viser answer."""
        try:
            return self._decide(path, headers)
        except ValueError:
            # A path that is no address, or bytes that are no text.
            return 400, {}, b"this request cannot be read\n"

    def _decide(self, path: str, headers: Any) -> tuple[int, dict[str, str], bytes] | None:
        if not self._known(headers.get("Host")):
            return 403, {}, b"this address is not one of the workbench's own (Host)\n"
        origin = headers.get("Origin")
        if origin is not None and not _same_site(origin, headers["Host"]):
            return 403, {}, b"pages of other sites may not drive the workbench (Origin)\n"
        where = urllib.parse.urlsplit(path)
        given = urllib.parse.parse_qs(where.query).get("token", [""])[0]
        known = self._opens(given) or self._opens(_cookie(headers.get("Cookie", ""), self.cookie))
        if where.path == HEALTH_PATH:
            said = self.health() if known else {"ok": True}
            return 200, {"Content-Type": "application/json"}, json.dumps(said).encode()
        if self.token is not None and given and known:
            cookie = f"{self.cookie}={self.token}; HttpOnly; SameSite=Lax; Path=/"
            return 302, {"Location": "/", "Set-Cookie": cookie}, b""
        if known:
            return None
        return 401, {}, b"open the link that the workbench printed in the terminal\n"

    @property
    def cookie(self) -> str:
        """Name of the cookie: two servers of a machine do not log each other's pages out."""
        return f"{COOKIE}_{self.port}"

    def _opens(self, given: str) -> bool:
        """Whether this is the token, or none is needed."""
        return self.token is None or secrets.compare_digest(given.encode(), self.token.encode())

    def _known(self, netloc: str | None) -> bool:
        if not netloc or "@" in netloc:
            return False
        host = netloc if netloc.endswith("]") else netloc.rsplit(":", 1)[0]
        if host.lower() in {known.lower() for known in self.hosts}:
            return True
        # Behind a token any address of the machine will do; a name could be another's.
        return self.token is not None and _is_address(host.strip("[]"))


def _cookie(text: str, name: str) -> str:
    """Value of a cookie, or "".

    Cookies of other programs on this machine come along, whose values need not be proper ones
    (`x={"a":1}`); the standard library's reader stops at the first such.
    """
    for item in text.split(";"):
        key, _, value = item.strip().partition("=")
        if key == name:
            return value.strip('"')
    return ""


def _same_site(origin: str, host: str) -> bool:
    """Whether a page of this origin is one of ours: same name and same port."""
    try:
        return urllib.parse.urlsplit(origin).netloc.lower() == host.lower()
    except ValueError:
        return False


def _is_address(text: str) -> bool:
    try:
        ipaddress.ip_address(text)
    except ValueError:
        return False
    return True


def _mended(page: Any, mend: Callable[[bytes, bool], bytes] | None) -> None:
    """Change the body of an answer that is a page."""
    if mend is not None and page.headers.get("Content-Type", "").startswith("text/html"):
        page.body = mend(page.body, page.headers.get("Content-Encoding") == "gzip")
        if "Content-Length" in page.headers:
            del page.headers["Content-Length"]
            page.headers["Content-Length"] = str(len(page.body))


def _is_news(record: logging.LogRecord) -> bool:
    """Whether a line of the log tells of more than a peer that went while it was being let in.

    Browsers open connections that they may need and close them unused, and a page that is closed
    while it loads leaves one half open: neither is worth a traceback in the terminal.
    """
    from websockets.exceptions import ConnectionClosed, InvalidMessage

    error = record.exc_info[1] if record.exc_info else None
    # Only these: a page that cannot be read raises an OSError or EOFError of its own here.
    cut = isinstance(error, InvalidMessage) and isinstance(error.__cause__, EOFError)
    gone = cut or isinstance(error, ConnectionClosed)
    return not (gone and record.getMessage() == "opening handshake failed")


def _log() -> logging.Logger:
    """Where connections of a workbench are logged."""
    log = logging.getLogger("workbench.connections")
    log.addFilter(_is_news)
    return log


@contextlib.contextmanager
def guarded(gate: Gate, mend: Callable[[bytes, bool], bytes] | None = None) -> Iterator[None]:
    """While this is open, every websocket server that is built asks the gate first.

    Args:
        gate: Who may talk to it.
        mend: Of the bytes of a page file and whether they are packed by gzip, what is sent instead.
    """
    import websockets.asyncio.server as asyncio_server
    from websockets import Headers
    from websockets.http11 import Response

    real = asyncio_server.serve

    def serve(
        handler: Any, host: Any, port: Any, *, process_request: Any = None, **rest: Any
    ) -> Any:
        rest |= {"max_size": MOST_MESSAGE_BYTES, "ping_interval": PING_S, "ping_timeout": PONG_S}
        rest |= {"logger": _log()}

        def ask(connection: Any, request: Any) -> Any:
            try:
                answer = gate.decide(request.path, request.headers)
            except LookupError:
                # Two headers of one name: which of them is meant cannot be told.
                answer = 400, {}, b"a header is given twice\n"
            if answer is None:
                page = process_request(connection, request) if process_request else None
                if page is not None:
                    _mended(page, mend)
                    page.headers.update(SAFE_HEADERS)
                return page
            status, headers, body = answer
            own = {"Content-Length": str(len(body)), **SAFE_HEADERS, **headers}
            return Response(status, "", Headers(own), body)

        return real(handler, host, port, process_request=ask, **rest)

    asyncio_server.serve = serve  # pyright: ignore[reportAttributeAccessIssue]
    try:
        yield
    finally:
        asyncio_server.serve = real
