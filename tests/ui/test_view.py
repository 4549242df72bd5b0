"""Looking at a sensor in a real browser: cut, measure, probe, play, and take the scene away."""

from __future__ import annotations

import re
import shutil
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.ui.conftest import Server
from tests.ui.test_image_click import wait_for_probe
from tests.ui.warm_start import WarmStart
from tests.ui.widgets import (
    button,
    changed_share,
    coarse_project,
    control,
    open_page,
    set_number,
    slider_value,
    switch,
    tab,
    view,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

MIDDLE, BESIDE = (640, 420), (420, 160)
"""Pixels of the page where the finger is, and where it is not."""


@pytest.fixture(scope="module")
def server(
    warm: WarmStart, tmp_path_factory: pytest.TempPathFactory, pressed_store: Path
) -> Iterator[Server]:
    """A workbench at a coarse finger, whose press all tests look at."""
    project = coarse_project(tmp_path_factory.mktemp("view"))
    shutil.copytree(pressed_store, project / "store")
    design = project / "designs" / "autosave.toml"
    design.write_text(design.read_text().replace('"coarse"', '"<b>cut</b>"'))
    with Server(project, warm=warm) as running:
        yield running


def pressed(page: Any, server: Server) -> None:
    """Open the page at the finger that has been pressed."""
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")


def said(page: Any, pattern: str) -> re.Match[str]:
    """What the page says, once it says it."""

    def found() -> re.Match[str] | None:
        return re.search(pattern, page.locator("body").inner_text())

    wait_until(found, 20, pattern)
    match = found()
    assert match is not None
    return match


def reasons_close(page: Any) -> None:
    """The reason of a figure, which opens over the page, goes by Escape or a press elsewhere."""
    contrast = page.locator("details[name=headline]").filter(has=page.get_by_title("Contrast:"))
    reason = contrast.locator("> div")
    for close in (lambda: page.keyboard.press("Escape"), lambda: page.mouse.click(*BESIDE)):
        contrast.locator("summary").click()
        reason.wait_for()
        close()
        reason.wait_for(state="hidden")


def tabs_stay(page: Any) -> None:
    """The row of tabs is there at the end of a long page too."""
    tab(page, "Optics").click()
    last = button(page, "Help: Optics")
    last.wait_for()
    before = tab(page, "Optics").bounding_box()
    last.scroll_into_view_if_needed()
    box, there = last.bounding_box(), tab(page, "Optics").bounding_box()
    assert box["y"] < page.viewport_size["height"]
    # What stands above it scrolls away, and no more.
    assert 0 <= there["y"] < before["y"]
    top = f"document.elementFromPoint({there['x'] + 5}, {there['y'] + 5})"
    assert page.evaluate(f"{top}.closest('[role=tab]') !== null")
    tab(page, "Shape").click()


def test_section_measure_and_a_file(tmp_path: Path, page: Any, server: Server) -> None:
    """A cut shows its caps and outlives an edit; a wall is measured; the file plays by itself."""
    pressed(page, server)
    reasons_close(page)
    tabs_stay(page)
    tab(page, "View").click()
    whole = view(page)
    switch(page, "Section")
    wait_until(lambda: changed_share(whole, view(page)) > 0.05, 20, "the section is drawn")
    cut = view(page)
    set_number(page, "Straight length mm", 24)
    wait_until(lambda: changed_share(cut, view(page)) > 0.01, 30, "the body is rebuilt")
    # The eye stays, and so does the cut: most of the view is as it was.
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 30, "the body is there")
    assert changed_share(cut, view(page)) < changed_share(whole, view(page))
    set_number(page, "Straight length mm", 27)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 60, "the press is found again")

    button(page, "Measure distance").click()
    page.get_by_text("Click the first point.").wait_for()
    page.mouse.click(*MIDDLE)
    page.get_by_text("Click the second point.").wait_for()
    page.mouse.click(MIDDLE[0] - 50, MIDDLE[1])
    match = said(page, r"(\S+) mm \(dx (\S+), dy (\S+), dz (\S+) mm\)")
    length, *way = (float(number) for number in match.groups())
    assert length > 1.0
    # Each number is rounded to a hundredth.
    assert length == pytest.approx(float(np.linalg.norm(way)), abs=0.02)
    page.keyboard.press("Escape")

    with page.expect_download() as download:
        button(page, "Save scene (HTML)").click()
    path = tmp_path / download.value.suggested_filename
    download.value.save_as(path)
    text = path.read_text()
    assert "<title>&lt;b&gt;cut&lt;/b&gt;</title>" in text
    assert "<b>cut" not in text
    page.goto(path.as_uri())
    page.locator("canvas").first.wait_for()
    time.sleep(3.0)
    assert view(page).std() > 10.0
    clock = page.locator("input").first
    before = clock.input_value()
    wait_until(lambda: clock.input_value() != before, 10, "the file plays")


def test_probe_returns_to_its_pixel(page: Any, server: Server) -> None:
    """A click on the skin has a pixel; that pixel, typed in, sees the place that was clicked."""
    pressed(page, server)
    page.get_by_text("Pixel and skin").click()
    switch(page, "Probe on click")
    wait_for_probe(page)
    page.mouse.click(*MIDDLE)
    pattern = r"pixel (\d+), (\d+) sees (\S+), (\S+), (\S+) mm\s+(\S+) × (\S+) mm per pixel"
    numbers = [float(number) for number in said(page, pattern).groups()]
    column, row, clicked, sizes = numbers[0], numbers[1], numbers[2:5], numbers[5:]
    assert slider_value(page, "Pixel column px") == column
    assert slider_value(page, "Pixel row px") == row
    assert page.get_by_text("Contact ✓").count(), "a probing click must not aim the press"
    set_number(page, "Pixel column px", column + 20)
    wait_until(lambda: f"pixel {column + 20:.0f}, " in page.locator("body").inner_text(), 10, "it")
    set_number(page, "Pixel column px", column)
    wait_until(lambda: f"pixel {column:.0f}, " in page.locator("body").inner_text(), 10, "back")
    there = [float(number) for number in said(page, pattern).groups()[2:5]]
    # The middle of the pixel is at most half a pixel from the click along both ways.
    assert np.linalg.norm(np.subtract(there, clicked)) < max(sizes)


def test_playing_stops_at_the_end_or_loops(page: Any, server: Server) -> None:
    """Without Loop the last frame stays; with it the frames come round again; keys step."""
    pressed(page, server)
    wait_until(lambda: slider_value(page, "Frame") == 2, 20, "the last frame is shown")
    button(page, "Play / pause").click()
    seen = set()
    deadline = time.monotonic() + 3.0
    while time.monotonic() < deadline:
        seen.add(slider_value(page, "Frame"))
    assert slider_value(page, "Frame") == 2
    tab(page, "Pace").click()
    switch(page, "Loop")
    tab(page, "Timeline").click()
    button(page, "Play / pause").click()
    # Five seconds are enough where the browser draws; without a GPU it may take them for one turn.
    deadline = time.monotonic() + 30.0
    turns, last = 0, 2.0
    while turns < 2 and time.monotonic() < deadline:
        now = slider_value(page, "Frame")
        turns += now < last
        last = now
    assert turns >= 2, f"came round {turns} times, saw {seen}"
    page.locator("body").press("p")
    time.sleep(1.0)
    stopped = slider_value(page, "Frame")
    page.locator("body").press("j")
    wait_until(lambda: slider_value(page, "Frame") == max(stopped - 1, 0), 10, "a frame back")


def test_arrows_on_a_slider_leave_the_eye(page: Any, server: Server) -> None:
    """They step through frames; where nothing has the focus they turn the eye, as viser has it."""
    pressed(page, server)
    # Where the test before has left it.
    set_number(page, "Frame", 2)
    wait_until(lambda: slider_value(page, "Frame") == 2, 20, "the last frame is shown")
    eye = "() => window.__viserMutable.camera.position.toArray()"

    def hold() -> Any:
        page.keyboard.down("ArrowLeft")
        page.wait_for_timeout(1_000)
        page.keyboard.up("ArrowLeft")
        page.wait_for_timeout(1_000)
        return page.evaluate(eye)

    before, frame = page.evaluate(eye), slider_value(page, "Frame")
    control(page, "Frame").locator('[role="slider"]').focus()
    assert np.allclose(hold(), before)
    assert slider_value(page, "Frame") == frame - 1
    page.evaluate("() => document.activeElement.blur()")
    assert not np.allclose(hold(), before, atol=0.5)
