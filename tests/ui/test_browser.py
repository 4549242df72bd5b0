"""A designer's task in a real browser: shape, press, look, cancel, restart."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    coarse_project,
    drag,
    image_source,
    open_page,
    set_number,
    slider_value,
    tab,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]


def test_shape_press_and_look(tmp_path: Path, page: Any, start_server: Start) -> None:
    """Move a slider and press: the image changes, and the force is shown."""
    server = start_server(coarse_project(tmp_path), cold=True)
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
    page.get_by_text("along the normal").first.wait_for()
    page.screenshot(path=str(tmp_path / "pressed.png"))


def test_refused_value_is_explained_and_the_design_kept(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """A wall that does not fit is refused under its slider; the next good value clears it.

    A good value of another slider puts the wall of the design back.
    """
    server = start_server(unpressed_project)
    open_page(page, server.url)
    set_number(page, "Outer radius mm", 6)
    set_number(page, "Elastomer mm", 5.5)
    wait_until(lambda: page.get_by_text("leave less than").count(), 20, "the refusal is shown")
    set_number(page, "Elastomer mm", 1.5)
    wait_until(lambda: not page.get_by_text("leave less than").first.is_visible(), 20, "cleared")
    set_number(page, "Elastomer mm", 5.5)
    wait_until(lambda: page.get_by_text("leave less than").count(), 20, "the refusal is shown")
    set_number(page, "Straight length mm", 24)
    wait_until(lambda: slider_value(page, "Elastomer mm") == 1.5, 20, "the wall is the design's")


def test_cancel_stops_a_press_within_three_seconds(
    pressed_project: Path, page: Any, start_server: Start
) -> None:
    """Cancel during a long press: the button disappears within 3 s, and the next run works."""
    server = start_server(pressed_project)
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
    page.get_by_text("Contact ○").first.wait_for()
    set_number(page, "Frames", 1)
    wait_until(lambda: slider_value(page, "Frames") == 1, 10, "one frame is asked for")
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

    again = start_server(project, cold=True)
    open_page(page, again.url)
    wait_until(lambda: page.get_by_text("Mesh ✓").count(), 30, "the mesh is found")
    page.get_by_text("Contact ○").first.wait_for()
    assert "coarse" in page.locator("body").inner_text()
    tab(page, "Simulate").click()
    assert slider_value(page, "Frames") == 40
    set_number(page, "Frames", 2)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 30, "the finished press is found")


def test_foreign_pages_cannot_drive_the_workbench(
    unpressed_project: Path, start_server: Start
) -> None:
    """A WebSocket or request with a foreign Origin or Host gets 403."""
    import urllib.error
    import urllib.request

    server = start_server(unpressed_project)
    for headers in ({"Host": "evil.example"}, {"Origin": "http://evil.example"}):
        request = urllib.request.Request(f"{server.url}/", headers=headers)
        with pytest.raises(urllib.error.HTTPError) as caught:
            urllib.request.urlopen(request, timeout=5)
        assert caught.value.code == 403
        caught.value.close()
