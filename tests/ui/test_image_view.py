"""The tactile image as a view of its own: large, zoomed, wiped, over the page, in a browser."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.ui.conftest import Server
from tests.ui.test_image_click import MIDDLE, click_pixel, image, near, told, wait_for_probe
from tests.ui.widgets import control, open_page, slider_value, switch, tab, wait_until

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
WIPE = "Rest on the left %"


def times(picture: Any) -> float:
    """How many times an image is enlarged."""
    style = picture.get_attribute("style") or ""
    found = re.search(r"scale\(([0-9.]+)\)", style)
    return float(found.group(1)) if found else 1.0


def pixels(picture: Any) -> np.ndarray:
    """An image as it is drawn, grey values."""
    import cv2

    data = np.frombuffer(picture.screenshot(), dtype=np.uint8)
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_GRAYSCALE), dtype=np.int16)


def inside(box: dict[str, float], other: dict[str, float]) -> bool:
    """Whether two boxes of the page overlap."""
    return (
        box["x"] < other["x"] + other["width"]
        and other["x"] < box["x"] + box["width"]
        and box["y"] < other["y"] + other["height"]
        and other["y"] < box["y"] + box["height"]
    )


@pytest.fixture
def pressed(pressed_project: Path, page: Any, start_server: Start) -> Any:
    """The page at a finger that has been pressed."""
    server = start_server(pressed_project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    return page


def test_the_image_is_large_beside_the_sensor_and_over_the_page(pressed: Any) -> None:
    """By keys: half as wide again at least without covering the timeline; then nearly the page."""
    page = pressed
    small = image(page).bounding_box()["width"]
    scene = page.locator("canvas[data-engine]")
    width = scene.bounding_box()["width"]
    page.keyboard.press("i")
    wait_until(lambda: image(page).bounding_box()["width"] > 1.5 * small, 20, "a larger image")
    bar = tab(page, "Timeline").locator("xpath=ancestor::*[contains(@style, 'z-index')][1]")
    wait_until(
        lambda: not inside(bar.bounding_box(), image(page).bounding_box()), 20, "both are seen"
    )
    page.keyboard.press("i")
    wait_until(lambda: image(page).bounding_box()["width"] < 1.1 * small, 20, "small again")
    # The 3D view takes its new room a moment after the page has given it.
    wait_until(lambda: scene.bounding_box()["width"] == width, 20, "the 3D view as at first")

    whole = page.locator(".whole-image img")
    page.keyboard.press("w")
    whole.wait_for()
    box = whole.bounding_box()
    assert box["height"] > 0.7 * page.viewport_size["height"]
    assert not inside(box, bar.bounding_box())
    wait_until(lambda: 200 < scene.bounding_box()["width"] < 400, 20, "the 3D view in a corner")
    assert not inside(box, scene.bounding_box()), "the 3D view beside it"
    assert whole.get_attribute("src") == image(page).get_attribute("src")
    now = whole.get_attribute("src")
    page.keyboard.press("j")
    wait_until(lambda: whole.get_attribute("src") != now, 20, "the frame before is shown there too")
    page.keyboard.press("Escape")
    wait_until(lambda: scene.bounding_box()["width"] == width, 20, "the 3D view is back")
    wait_until(lambda: not whole.count(), 20, "the page is seen again")


def test_a_zoomed_image_is_moved_and_clicked_as_it_is_seen(pressed: Any) -> None:
    """Image and change are enlarged alike; a place under the mouse is the pixel's; a drag pans."""
    page = pressed
    page.get_by_text("Pixel and skin").click()
    switch(page, "Probe on click")
    wait_for_probe(page)
    tools = page.locator(".zoom-image .image-tools")
    for _ in range(4):
        tools.locator("[data-act=in]").click()
    assert times(image(page)) == times(image(page, 2)) == pytest.approx(1.25**4, rel=1e-4)
    click_pixel(page, 170, 110)
    wait_until(lambda: near(page, 170, 110), 20, "the enlarged pixel is the one clicked")

    tools.scroll_into_view_if_needed()
    frame = image(page).locator("xpath=..").bounding_box()
    middle = frame["x"] + frame["width"] / 2, frame["y"] + frame["height"] / 2
    before = image(page).bounding_box()
    page.mouse.move(*middle)
    page.mouse.down()
    page.mouse.move(middle[0] + 40, middle[1] + 20, steps=5)
    page.mouse.up()
    after = image(page).bounding_box()
    assert after["x"] - before["x"] == pytest.approx(40, abs=2)
    assert after["y"] - before["y"] == pytest.approx(20, abs=2)
    page.wait_for_timeout(1000)
    assert near(page, 170, 110), "a drag is no click"
    switch(page, "Probe on click")
    page.locator(".probe-image").wait_for(state="detached")
    tools.scroll_into_view_if_needed()
    frame = image(page).locator("xpath=..").bounding_box()
    page.mouse.dblclick(frame["x"] + frame["width"] / 2, frame["y"] + frame["height"] / 2)
    wait_until(lambda: times(image(page)) == 1.0, 20, "the whole image is seen")

    switch(page, "Probe under the mouse")
    page.locator(".probe-image[data-hover]").wait_for(state="attached")
    tools.scroll_into_view_if_needed()
    frame = image(page).bounding_box()
    y = frame["y"] + frame["height"] / 2
    for share in (0.3, 0.6):
        page.mouse.move(frame["x"] + share * frame["width"], y, steps=3)
        wait_until(lambda at=share: _near_column(page, int(320 * at)), 20, "without a click")
    before = told(page)
    page.mouse.move(*MIDDLE, steps=3)
    wait_until(lambda: told(page) not in (None, before), 20, "the skin under the mouse has a pixel")
    assert not page.get_by_text("The press aims elsewhere").count(), (
        "a mouse that rests aims at nothing"
    )


def _near_column(page: Any, column: int) -> bool:
    now = told(page)
    return now is not None and abs(now.column - column) <= 1


def test_a_wipe_shows_the_untouched_skin_on_the_left(pressed: Any) -> None:
    """At 100 % the image is that of frame 0, at 50 % its left half; the page's own slider too."""
    page = pressed
    now = pixels(image(page))
    page.keyboard.press("w")
    whole = page.locator(".whole-image")
    whole.locator("img").wait_for()
    whole.locator("input").fill("50")
    wait_until(lambda: slider_value(page, WIPE) == 50, 20, "the slider follows")
    page.keyboard.press("Escape")
    half = pixels(image(page))
    whole_before = image(page).get_attribute("src")
    control(page, WIPE).locator("xpath=following-sibling::div//input").fill("100")
    page.keyboard.press("Tab")
    wait_until(lambda: image(page).get_attribute("src") != whole_before, 20, "another image")
    drawn = "image => image.complete && image.naturalWidth > 0"
    wait_until(lambda: image(page).evaluate(drawn), 20, "it is drawn")
    rest = pixels(image(page))
    assert np.abs(rest - now).max() > 20, "the press is seen"
    wide = now.shape[1] // 2 - 8
    # A jpeg of another whole differs by some levels at edges.
    assert np.abs(half[:, :wide] - rest[:, :wide]).mean() < 1.0
    assert np.abs(half[:, -wide:] - now[:, -wide:]).mean() < 1.0
