"""Who may talk to the workbench: Host and Origin checks, a token, and `/healthz`.

A server on loopback is still reachable from any web page the user has open; without these checks
such a page could drive the workbench. viser calls `websockets.asyncio.server.serve` itself, so
that one call is wrapped while the server is being built.
"""

from __future__ import annotations

import contextlib
import http.cookies
import ipaddress
import json
import secrets
import urllib.parse
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

LOOPBACK = ("127.0.0.1", "localhost", "[::1]")
COOKIE = "workbench_token"
HEALTH_PATH = "/healthz"
MOST_MESSAGE_BYTES = 16 * 2**20
"""Of one message: a file comes in parts of half a megabyte, a picture of the view in one."""
SAFE_HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "X-Frame-Options": "SAMEORIGIN",
}
"""Of every answer: no page of another site shows the workbench in a frame, or learns the token."""


@dataclass(kw_only=True)
class Gate:
    """The rules of one server."""

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
        if where.path == HEALTH_PATH:
            return 200, {"Content-Type": "application/json"}, json.dumps(self.health()).encode()
        if self.token is None or self._has_cookie(headers.get("Cookie", "")):
            return None
        given = urllib.parse.parse_qs(where.query).get("token", [""])[0]
        if secrets.compare_digest(given.encode(), self.token.encode()):
            cookie = f"{COOKIE}={self.token}; HttpOnly; SameSite=Lax; Path=/"
            return 302, {"Location": "/", "Set-Cookie": cookie}, b""
        return 401, {}, b"open the link that the workbench printed in the terminal\n"

    def _known(self, netloc: str | None) -> bool:
        if not netloc or "@" in netloc:
            return False
        host = netloc if netloc.endswith("]") else netloc.rsplit(":", 1)[0]
        if host.lower() in {known.lower() for known in self.hosts}:
            return True
        # Behind a token any address of the machine will do; a name could be another's.
        return self.token is not None and _is_address(host.strip("[]"))

    def _has_cookie(self, text: str) -> bool:
        jar: http.cookies.SimpleCookie = http.cookies.SimpleCookie()
        with contextlib.suppress(http.cookies.CookieError):
            jar.load(text)
        given = jar[COOKIE].value if COOKIE in jar else ""
        return secrets.compare_digest(given.encode(), (self.token or "").encode())


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


@contextlib.contextmanager
def guarded(gate: Gate) -> Iterator[None]:
    """While this is open, every websocket server that is built asks the gate first."""
    import websockets.asyncio.server as asyncio_server
    from websockets import Headers
    from websockets.http11 import Response

    real = asyncio_server.serve

    def serve(
        handler: Any, host: Any, port: Any, *, process_request: Any = None, **rest: Any
    ) -> Any:
        rest["max_size"] = MOST_MESSAGE_BYTES

        def ask(connection: Any, request: Any) -> Any:
            try:
                answer = gate.decide(request.path, request.headers)
            except LookupError:
                # Two headers of one name: which of them is meant cannot be told.
                answer = 400, {}, b"a header is given twice\n"
            if answer is None:
                page = process_request(connection, request) if process_request else None
                if page is not None:
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
