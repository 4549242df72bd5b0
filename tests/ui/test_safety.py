"""What may not get in: foreign pages, missing tokens, huge files, the tunnel, markup in names.

No browser is needed, except to see that markup in a name stays text.
"""

from __future__ import annotations

import http.client
import json
import re
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.warm_start import WarmStart
from tests.ui.widgets import coarse_project, open_page, upload, wait_until
from workbench.proof.benchmarks.tab import Tab

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
LENGTH = "Straight length mm"
PART = 512 * 1024
EVIL = "<script>window.pwned = 1</script><img src=x onerror='window.pwned = 1'>"


def memory_mb(pid: int) -> float:
    """Resident memory of a process [MB]."""
    status = Path(f"/proc/{pid}/status").read_text()
    found = re.search(r"VmRSS:\s+(\d+) kB", status)
    assert found is not None
    return int(found.group(1)) / 1000


def settled_mb(pid: int) -> float:
    """Resident memory once the server has loaded what it needs to draw [MB]."""
    before = 0.0
    while (now := memory_mb(pid)) > before + 0.5:
        before = now
        time.sleep(2.0)
    return now


def answered(server: Server, editor: Tab, value: float) -> None:
    """Wait until the server has read all that the editor sent: another tab sees this edit."""
    editor.set(LENGTH, value)
    with Tab(server.url) as follower:
        uuid = follower.uuid(LENGTH)
        follower.wait(lambda: follower.widgets[uuid].get("value") == value, 20, "the edit is seen")


def ask(server: Server, path: str, **headers: str) -> tuple[int, dict[str, str], str]:
    """Status, headers and body of a plain request, which follows no redirect."""
    connection = http.client.HTTPConnection("127.0.0.1", server.port, timeout=10)
    connection.putrequest("GET", path, skip_host="Host" in headers)
    for name, value in headers.items():
        connection.putheader(name, value)
    connection.endheaders()
    answer = connection.getresponse()
    body = answer.read().decode(errors="replace")
    connection.close()
    return answer.status, dict(answer.getheaders()), body


def refused(server: Server, headers: dict[str, str]) -> int:
    """Status with which the WebSocket is refused."""
    from websockets.exceptions import InvalidStatus

    with pytest.raises(InvalidStatus) as caught:
        Tab(server.url, headers=headers)
    return caught.value.response.status_code


@pytest.fixture(scope="module")
def server(warm: WarmStart, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server on loopback; what it refuses leaves it as it was."""
    with Server(coarse_project(tmp_path_factory.mktemp("safety")), warm=warm) as running:
        yield running


@pytest.fixture(scope="module")
def editor(server: Server) -> Iterator[Tab]:
    """The tab that edits.

    One for all tests: a tab that comes before the server has noticed that the former left follows
    for some hundredths of a second, and what it sends then is refused.
    """
    with Tab(server.url) as tab:
        tab.uuid("Load design (TOML)")
        yield tab


def send_file(tab: Tab, *, size: int, parts: int, content: bytes, name: str = "big.toml") -> None:
    """Send a file as a page does, or as one that lies about its size."""
    button, transfer = tab.uuid("Load design (TOML)"), f"transfer-{size}-{parts}"
    start = {"type": "FileTransferStartUpload", "source_component_uuid": button}
    start |= {"transfer_uuid": transfer, "filename": name, "mime_type": ""}
    tab.send({**start, "part_count": parts, "size_bytes": size})
    for number in range(parts):
        part = {"type": "FileTransferPart", "source_component_uuid": button}
        part |= {"transfer_uuid": transfer, "part_index": number, "content": content}
        tab.send(part)


def test_a_file_of_100_mb_is_refused_before_it_is_kept(server: Server, editor: Tab) -> None:
    """Told at its first message; 100 MB of parts leave the server's memory as it was."""
    before = settled_mb(server.process.pid)
    send_file(editor, size=100_000_000, parts=191, content=bytes(PART))
    editor.wait(
        lambda: editor.has_seen("big.toml has 100.0 MB, the browser takes 40 MB"), 20, "told"
    )
    answered(server, editor, 25.0)
    # A quarter of the file; parts in flight and Python's own habits need some.
    assert memory_mb(server.process.pid) - before < 25.0
    assert not editor.closed


def test_a_file_that_is_more_than_it_says_is_dropped(server: Server, editor: Tab) -> None:
    """1 MB announced in 100 parts is refused; of 120 MB sent as 6 nothing is kept."""
    before = settled_mb(server.process.pid)
    send_file(editor, size=1_000_000, parts=100, content=bytes(PART))
    send_file(editor, size=6_000_000, parts=12, content=bytes(10_000_000))
    answered(server, editor, 24.0)
    # Several messages of 10 MB may be in flight.
    assert memory_mb(server.process.pid) - before < 60.0


def test_a_message_beyond_the_cap_ends_only_its_tab(server: Server, editor: Tab) -> None:
    """30 MB in one message: the tab is closed, the next one is served."""
    with Tab(server.url) as rude:
        rude.uuid("Edit here")
        rude.send({"type": "FileTransferPart", "content": bytes(30_000_000)})
        rude.wait(lambda: rude.closed, 20, "it is closed")
    with Tab(server.url) as tab:
        tab.uuid("Edit here")
    assert not editor.closed


def test_nobody_opens_the_tunnel_or_sets_attributes(server: Server, editor: Tab) -> None:
    """viser's request for a public address is ignored, and only the value of a widget changes."""
    editor.send({"type": "ShareUrlRequest"})
    uuid = editor.uuid(LENGTH)
    editor.send({"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"removed": True}})
    answered(server, editor, 23.0)
    assert not editor.has_seen("ShareUrlUpdated")
    log = server.log.read_text()
    assert "share" not in log.lower()
    assert "Traceback" not in log


@pytest.mark.parametrize(
    "headers",
    [{"Host": "evil.example"}, {"Origin": "http://evil.example"}, {"Origin": "null"}],
    ids=str,
)
def test_foreign_pages_get_neither_page_nor_socket(server: Server, headers: dict[str, str]) -> None:
    """403 for a foreign Host or Origin, over HTTP and over the WebSocket."""
    assert ask(server, "/", **headers)[0] == 403
    assert ask(server, "/healthz", **headers)[0] == 403
    # This client adds its own Host, and two of them are not even looked at.
    assert refused(server, headers) == (400 if "Host" in headers else 403)


def test_health_tells_nothing_private(server: Server) -> None:
    """Whether it runs, which version, whether it is busy: no path, name or token."""
    told = {"ok", "version", "busy"}
    wait_until(lambda: set(json.loads(ask(server, "/healthz")[2])) == told, 20, "it is built")
    status, headers, body = ask(server, "/healthz")
    assert status == 200
    assert "Set-Cookie" not in headers
    assert str(server.project) not in body


def test_another_host_needs_the_token_that_is_printed_once(
    tmp_path: Path, start_server: Start
) -> None:
    """401 without, with a wrong one, and with a cookie of another; a new one at every start."""
    tokens = set()
    for number in range(2):
        folder = tmp_path / str(number)
        folder.mkdir()
        server = start_server(coarse_project(folder), "--host", "0.0.0.0", cold=True)
        wait_until(lambda s=server: "token=" in s.log.read_text(), 20, "the link is printed")
        (token,) = set(re.findall(r"token=([\w-]{20,})", server.log.read_text()))
        tokens.add(token)
        for path, cookie in (
            ("/", ""),
            ("/?token=wrong", ""),
            ("/", f"workbench_token_{server.port}=wrong"),
        ):
            headers = {"Cookie": cookie} if cookie else {}
            assert ask(server, path, **headers)[0] == 401
            assert refused(server, headers) == 401
        status, headers, _ = ask(server, f"/?token={token}")
        assert status == 302
        assert token not in headers["Location"]
        for flag in ("HttpOnly", "SameSite=Lax"):
            assert flag in headers["Set-Cookie"]
        good = {"Cookie": headers["Set-Cookie"].split(";")[0]}
        assert ask(server, "/", **good)[0] == 200
        with Tab(server.url, headers=good) as tab:
            tab.uuid("Load design (TOML)")
        assert refused(server, {**good, "Origin": "http://evil.example"}) == 403
        server.stop()
    assert len(tokens) == 2


def test_markup_in_a_name_stays_text(tmp_path: Path, page: Any, start_server: Start) -> None:
    """A design named <script> is shown as it is written, in the title and wherever it is told."""
    project = coarse_project(tmp_path)
    file = project / "designs" / "autosave.toml"
    file.write_text(file.read_text().replace('name = "coarse"', f"name = {json.dumps(EVIL)}"))
    server = start_server(project)
    open_page(page, server.url)
    page.get_by_text("<script>window.pwned").first.wait_for()
    # The name of a refused file passes the log and a notification.
    file = tmp_path / "<img src=x onerror='window.pwned = 1'>.toml"
    file.write_text(f"name = {json.dumps(EVIL)}\nfamily = {json.dumps(EVIL)}")
    page.get_by_text("Design files", exact=True).first.click()
    upload(page, "Load design (TOML)", file)
    page.get_by_text("onerror").nth(1).wait_for()
    assert page.evaluate("window.pwned") is None
    assert page.evaluate("document.querySelectorAll('img[src=x]').length") == 0


MARKUP = '<iframe srcdoc="&lt;b">[x](javascript:alert(1))'
"""A frame and a link; a name of a file has no slash."""


def test_no_text_of_others_becomes_markup(tmp_path: Path, start_server: Start) -> None:
    """Names of design, body and picture, tags and notes: no Markdown holds a frame or a link."""
    import trimesh

    project = coarse_project(tmp_path)
    (project / "bodies").mkdir()
    box = trimesh.creation.box((20.0, 20.0, 20.0)).export(file_type="stl")
    (project / "bodies" / "box.stl").write_bytes(bytes(box))
    named = json.dumps(MARKUP)
    body = f'[body]\nouter = "bodies/box.stl"\nouter_name = {json.dumps(MARKUP + ".stl")}\n'
    head = f'name = {named}\nfamily = "imported"\n'
    (project / "designs" / "autosave.toml").write_text(head + body)
    (project / "variants").mkdir()
    about = f"[variant]\ntags = [{named}]\nnote = {named}\n"
    about += "metrics = {}\nkeys = {}\n"
    (project / "variants" / "a.toml").write_text(head + body + about)
    server = start_server(project)
    with Tab(server.url) as tab:
        # The file's name, the design's name and a refusal that quotes both.
        tab.wait(lambda: tab.has_seen("outer &lt;iframe"), 20, "the body is named")
        send_file(
            tab,
            size=len(text := f"family = {named}".encode()),
            parts=1,
            content=text,
            name=f"{MARKUP}.toml",
        )
        tab.wait(lambda: tab.has_seen("there is no sensor family"), 20, "the family is refused")
        shown = [
            (key, str(text))
            for _, message in list(tab.seen)
            for props in (message.get("props"), message.get("updates"))
            if isinstance(props, dict)
            for key, text in props.items()
            if key in ("_markdown", "content")
        ]
    assert sum("iframe" in text for _, text in shown) >= 4
    for key, text in shown:
        assert "<iframe" not in text
        assert key == "content" or "](javascript" not in text
