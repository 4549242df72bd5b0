"""A click on the tactile image finds its place on the skin, in a real browser."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    DRAW_WHEN_LOOKED_AT,
    VISIBLE_CHANGE,
    button,
    looking,
    open_page,
    slider_value,
    switch,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
SAID = r"pixel (\d+), (\d+) sees (\S+), (\S+), (\S+) mm\s+(\S+) × (\S+) mm per pixel"
SIZE_PX = (320, 240)
"""Of the camera of the coarse project."""
MARK_PX = 60
"""Pixels of the page that a mark changes at least."""
MIDDLE = (640, 420)
"""A place of the page where the finger is."""


def image(page: Any, number: int = 0) -> Any:
    """An image of the tactile image's tab."""
    return page.locator("img[src^='blob:']:visible").nth(number)


def click_pixel(page: Any, column: int, row: int, number: int = 0) -> None:
    """Click the middle of a pixel of the camera, as large as its image is shown."""
    image(page, number).scroll_into_view_if_needed()
    box = image(page, number).bounding_box()
    x = box["width"] * (column + 0.5) / SIZE_PX[0]
    y = box["height"] * (row + 0.5) / SIZE_PX[1]
    page.mouse.click(box["x"] + x, box["y"] + y)


def wait_for_probe(page: Any) -> None:
    """Wait until clicks are taken: the server answers the box, and the page runs the answer."""
    page.locator(".probe-image").wait_for(state="attached")
    wait_until(lambda: page.evaluate("Boolean(window.probeImage)"), 20, "clicks are taken")


class Told(NamedTuple):
    """What the text tells of a pixel."""

    column: int
    row: int
    place_mm: tuple[float, ...]
    size_mm: float
    """Of the pixel on the skin, the larger way."""


def told(page: Any) -> Told | None:
    """What the text tells; None while it tells nothing."""
    found = re.search(SAID, page.locator("body").inner_text())
    if found is None:
        return None
    column, row, *rest = (float(word) for word in found.groups())
    return Told(int(column), int(row), tuple(rest[:3]), max(rest[3:]))


def near(page: Any, column: int, row: int) -> bool:
    """Whether the text tells this pixel, within one."""
    now = told(page)
    return now is not None and abs(now.column - column) <= 1 and abs(now.row - row) <= 1


def scene(page: Any) -> np.ndarray:
    """Grey values of the middle of the 3D view, between the docks."""
    import cv2

    clip = {"x": 400, "y": 100, "width": 520, "height": 500}
    with looking(page):
        data = np.frombuffer(page.screenshot(clip=clip), dtype=np.uint8)
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_GRAYSCALE), dtype=np.int16)


def marked(page: Any, bare: np.ndarray) -> bool:
    """Whether ball and label stand in the view, which was bare."""
    return int((np.abs(scene(page) - bare) > VISIBLE_CHANGE).sum()) > MARK_PX


def test_a_click_on_the_picture_finds_what_a_click_on_the_skin_had_there(
    pressed_project: Path, browser: Any, start_server: Start
) -> None:
    """Boxes, mark and text within a pixel, on a screen of 1.5 pixels per point; a follower cannot.

    A place clicked on the skin has a pixel; that pixel, clicked in the image, sees the place.
    """
    server = start_server(pressed_project)
    context = browser.new_context(
        viewport={"width": 1280, "height": 1000}, device_scale_factor=1.5, color_scheme="dark"
    )
    context.add_init_script(DRAW_WHEN_LOOKED_AT)
    page = context.new_page()
    page.set_default_timeout(60_000)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    click_pixel(page, 160, 120)
    page.get_by_text("Pixel and skin").click()
    page.wait_for_timeout(500)
    assert told(page) is None, "a click does nothing until it is asked for"

    switch(page, "Probe on click")
    wait_for_probe(page)
    bare = scene(page)
    page.mouse.click(*MIDDLE)
    wait_until(lambda: told(page), 20, "the skin's place has a pixel")
    there = told(page)
    assert there is not None
    wait_until(lambda: marked(page, bare), 20, "the place is marked in the view")
    button(page, "Clear probe").click()
    wait_until(lambda: told(page) is None and not marked(page, bare), 20, "all is cleared")

    column, row = there.column, there.row
    click_pixel(page, column, row)
    wait_until(lambda: near(page, column, row), 20, "the text tells the pixel that was clicked")
    assert abs(slider_value(page, "Pixel column px") - column) <= 1
    assert abs(slider_value(page, "Pixel row px") - row) <= 1
    back = told(page)
    # A mouse knows whole points, and a pixel is about as large: it may be the next one across a
    # corner (1.41 pixels), from a place that may be at a corner of its own (0.71).
    assert back is not None
    assert np.linalg.norm(np.subtract(back.place_mm, there.place_mm)) < 2.2 * there.size_mm
    wait_until(lambda: marked(page, bare), 20, "the place is marked in the view")

    click_pixel(page, 130, 140, number=1)
    wait_until(lambda: near(page, 130, 140), 20, "the image of the change takes clicks too")
    follower = context.new_page()
    open_page(follower, server.url)
    image(follower).wait_for()
    follower.wait_for_timeout(1500)
    click_pixel(follower, 200, 90)
    follower.wait_for_timeout(2000)
    assert near(page, 130, 140), "a tab that follows changes nothing"
    context.close()
