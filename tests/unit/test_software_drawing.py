"""The script at the head of the page file, and the answer that carries it."""

from __future__ import annotations

import gzip
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import viser
import websockets.asyncio.server
from websockets import Headers
from websockets.http11 import Response

from ui.guard import Gate, guarded
from ui.patches.software_drawing import SCRIPT, page_with_script

PAGE = b"<!doctype html><html><head><script>let a;</script></head><body><head></body></html>"


@pytest.mark.parametrize("packed", [False, True])
def test_the_script_is_the_first_of_the_page(packed: bool) -> None:
    """Once, before every other one; the rest stays as it was, packed or not."""
    given = gzip.compress(PAGE) if packed else PAGE
    made = page_with_script(given, packed)
    text = (gzip.decompress(made) if packed else made).decode()
    assert text.index(SCRIPT) < text.index("let a;")
    assert text.replace(f"<script>{SCRIPT}</script>", "", 1).encode() == PAGE


def test_the_page_of_viser_has_one_head_before_its_scripts() -> None:
    """Where it stands otherwise one day, the script must go elsewhere."""
    page = (Path(viser.__file__).parent / "client" / "build" / "index.html").read_bytes()
    assert 0 < page.index(b"<head>") < page.index(b"<script")


@pytest.mark.parametrize("kind", ["text/html; charset=utf-8", "image/png"])
def test_an_answer_that_is_a_page_is_mended(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its length is told anew; files of other kinds are sent as they are."""
    asked: list[Callable[..., Any]] = []

    def serve(*given: Any, process_request: Callable[..., Any], **rest: Any) -> None:
        asked.append(process_request)

    def answered(connection: Any, request: Any) -> Response:
        headers = Headers({"Content-Type": kind, "Content-Length": str(len(PAGE))})
        return Response(200, "OK", headers, PAGE)

    monkeypatch.setattr(websockets.asyncio.server, "serve", serve)
    with guarded(Gate(port=8080), page_with_script):
        built: Any = websockets.asyncio.server.serve
        built(None, None, None, process_request=answered)

    class Request:
        path, headers = "/", Headers({"Host": "127.0.0.1:8080"})

    page = asked[0](None, Request())
    assert (SCRIPT.encode() in page.body) == kind.startswith("text/html")
    assert page.headers.get_all("Content-Length") == [str(len(page.body))]
    assert page.headers["X-Content-Type-Options"] == "nosniff"
