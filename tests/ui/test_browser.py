"""A designer's task in a real browser: shape, press, look, cancel, download, restart."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    drag,
    image_source,
    open_page,
    set_number,
    slider_value,
    tab,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
COARSE = """
name = "coarse"
family = "finger"
[meshing]
hex_mm = 0.8
[optics.camera]
width_px = 320
height_px = 240
[press_case.press]
frames = 2
[press_case.settings]
grid_mm = 1.0
active_radius_mm = 9.0
"""


def wait_until(condition: Callable[[], Any], seconds: float, what: str) -> None:
    """Poll until the condition holds."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.2)
    raise AssertionError(f"after {seconds} s still not: {what}")


def coarse_project(tmp_path: Path) -> Path:
    """A project whose last session was a coarse finger, quick to press."""
    project = tmp_path / "project"
    (project / "designs").mkdir(parents=True)
    (project / "designs" / "autosave.toml").write_text(COARSE)
    return project


def test_shape_press_look_and_download(tmp_path: Path, page: Any, start_server: Start) -> None:
    """Move a slider, press, see the image change, download a mould part: it is watertight."""
    import trimesh

    server = start_server(coarse_project(tmp_path))
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Contact ✓").count(), 180, "the example is pressed")

    drag(page, "Straight length mm", 0.32, 0.2)
    wait_until(lambda: page.get_by_text("Contact ○").count(), 20, "the contact is stale")
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 30, "the new shape is built")
    assert slider_value(page, "Straight length mm") < 25

    before = image_source(page)
    tab(page, "Simulate").click()
    set_number(page, "Depth mm", 1.2)
    button(page, "Run press").click()
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the image is rendered")
    wait_until(lambda: image_source(page) != before, 20, "the tactile image changed")
    assert page.get_by_text("along the normal").count()
    page.screenshot(path=str(tmp_path / "pressed.png"))

    tab(page, "Make").click()
    button(page, "Make mould").click()
    button(page, "Download part STL").wait_for(timeout=120_000)
    wait_until(lambda: page.get_by_text("Mould ✓").count(), 60, "the mould is stored")
    wait_until(lambda: not button(page, "Cancel").is_visible(), 60, "nothing runs")
    with page.expect_download() as download:
        button(page, "Download part STL").click()
    content = Path(download.value.path()).read_bytes()
    mesh = trimesh.load(io.BytesIO(content), file_type="stl")
    assert mesh.is_watertight
    assert mesh.volume > 1000
    page.screenshot(path=str(tmp_path / "mould.png"))


def test_refused_value_is_explained_and_the_design_kept(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """A wall that does not fit is refused under its slider; the next good value clears it."""
    server = start_server(coarse_project(tmp_path))
    open_page(page, server.url)
    set_number(page, "Outer radius mm", 6)
    set_number(page, "Elastomer mm", 5.5)
    wait_until(lambda: page.get_by_text("leave less than").count(), 20, "the refusal is shown")
    set_number(page, "Elastomer mm", 1.5)
    wait_until(lambda: not page.get_by_text("leave less than").first.is_visible(), 20, "cleared")


def test_cancel_stops_a_press_within_three_seconds(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """Cancel during a long press: the button disappears within 3 s, and the next run works."""
    server = start_server(coarse_project(tmp_path))
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Contact ✓").count(), 180, "the example is pressed")
    tab(page, "Simulate").click()
    set_number(page, "Frames", 40)
    set_number(page, "Depth mm", 1.5)
    button(page, "Run press").click()
    button(page, "Cancel").wait_for(timeout=30_000)
    time.sleep(0.5)
    clicked = time.monotonic()
    button(page, "Cancel").click()
    button(page, "Cancel").wait_for(state="hidden", timeout=10_000)
    # The promise is 3 s; the browser's own polling adds up to half a second.
    assert time.monotonic() - clicked < 3.5
    assert page.get_by_text("Contact ○").count()
    set_number(page, "Frames", 1)
    button(page, "Run press").click()
    wait_until(lambda: page.get_by_text("Contact ✓").count(), 180, "the next press is done")


def test_restart_after_kill_finds_design_and_results(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """kill -9 during a press: the restart has the design, finished results, no half-written one."""
    project = coarse_project(tmp_path)
    server = start_server(project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    tab(page, "Simulate").click()
    set_number(page, "Frames", 40)
    time.sleep(2.0)
    button(page, "Run press").click()
    button(page, "Cancel").wait_for(timeout=30_000)
    server.kill()

    again = start_server(project)
    open_page(page, again.url)
    wait_until(lambda: page.get_by_text("Mesh ✓").count(), 30, "the mesh is found")
    assert page.get_by_text("Contact ○").count()
    assert "coarse" in page.locator("body").inner_text()
    tab(page, "Simulate").click()
    assert slider_value(page, "Frames") == 40
    set_number(page, "Frames", 2)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 30, "the finished press is found")


def test_foreign_pages_cannot_drive_the_workbench(tmp_path: Path, start_server: Start) -> None:
    """A WebSocket or request with a foreign Origin or Host gets 403."""
    import urllib.error
    import urllib.request

    server = start_server(coarse_project(tmp_path))
    for headers in ({"Host": "evil.example"}, {"Origin": "http://evil.example"}):
        request = urllib.request.Request(f"{server.url}/", headers=headers)
        with pytest.raises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(request, timeout=5)
        assert caught.value.code == 403
        caught.value.close()
