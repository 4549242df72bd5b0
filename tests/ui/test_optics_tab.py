"""Optics as a designer sets them in a real browser: lights, lenses, views of images, maps."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    boxes,
    button,
    choose,
    control,
    image_source,
    labels,
    open_page,
    set_number,
    slider_value,
    tab,
    type_numbers,
    type_text,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]


def optics(page: Any, server: Server, *, pressed: bool) -> None:
    """Open the page and go to Optics, once the example that is pressed is on show."""
    open_page(page, server.url)
    if pressed:
        wait_until(lambda: page.get_by_text("Image ✓").count(), 110, "the example is pressed")
    tab(page, "Optics").click()


def folder(page: Any, name: str) -> None:
    """Open or close a folder."""
    page.get_by_text(name, exact=True).first.click()


def test_light_model_lamp_lens_and_views(
    tmp_path: Path, pressed_project: Path, page: Any, start_server: Start
) -> None:
    """A model, an area of light, a fisheye and a second camera: rendered, seen as normals."""
    server = start_server(pressed_project)
    optics(page, server, pressed=True)
    choose(page, "Model", "straight rays")
    page.get_by_text("the paper's linear field").wait_for()
    folder(page, "LED ring")
    folder(page, "Further lights")
    button(page, "area").click()
    wait_until(lambda: "Lamp colour" in labels(page), 20, "there is a lamp")
    set_number(page, "Length mm", 3)
    type_text(page, "Lamp colour", "525nm")
    button(page, "160").click()
    wait_until(lambda: slider_value(page, "View deg") == 160, 20, "the lens is wide")
    button(page, "Add").click()
    wait_until(lambda: "Edited" in labels(page), 20, "there is a second camera")
    assert slider_value(page, "Tilt deg") == 20
    page.get_by_text("Light ○").first.wait_for()

    button(page, "Render image").click()
    wait_until(lambda: page.get_by_text("Image ✓").count(), 100, "the image is rendered")
    first = image_source(page)
    choose(page, "Show", "normals")
    page.get_by_text("normals toward the camera").wait_for()
    wait_until(lambda: image_source(page) != first, 20, "the image is another")
    choose(page, "Show", "depth")
    page.get_by_text("depth along the optical axis").wait_for()
    page.screenshot(path=str(tmp_path / "views.png"))
    button(page, "camera 2").click()
    button(page, "● camera 2").wait_for()
    choose(page, "Show", "image")
    wait_until(lambda: image_source(page) != first, 20, "the other camera sees something else")


def test_bought_parts_set_their_numbers(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """A module sets pixels and view, an LED colours; a number of one's own makes it no module."""
    server = start_server(unpressed_project)
    optics(page, server, pressed=False)
    assert control(page, "Module").input_value() == "own numbers"
    choose(page, "Module", "Raspberry Pi Camera Module 2")
    wait_until(lambda: control(page, "Width px").input_value() == "1640", 20, "it is taken")
    choose(page, "LED type", "Kingbright KP-1608PBC")
    told = boxes(page, "LED colours").first
    wait_until(lambda: told.input_value() == "468nm/25nm", 20, "the LEDs are blue")
    set_number(page, "View deg", 80)
    wait_until(
        lambda: control(page, "Module").input_value() == "own numbers", 20, "it is no module"
    )


def test_maps_are_measured_shown_and_read(
    tmp_path: Path, unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """Measured without a press; a map has legend and score, a click on the skin tells its value."""
    server = start_server(unpressed_project)
    optics(page, server, pressed=False)
    page.get_by_role("tab", name="Maps").click()
    button(page, "Measure maps").click()
    wait_until(lambda: page.get_by_text("Maps ✓").count(), 100, "the maps are measured")
    page.get_by_role("cell", name="skin seen", exact=True).wait_for()
    assert control(page, "Show on the skin").is_checked()
    choose(page, "Map", "Angle of view")
    page.get_by_text("90 is edge-on").wait_for()
    page.get_by_text("5, 50 and 95 % of the skin").wait_for()
    assert page.get_by_text(re.compile(r"^\d+(\.\d+)? deg$")).count() == 2
    page.wait_for_timeout(2000)
    page.screenshot(path=str(tmp_path / "map.png"))
    box = page.locator("canvas").first.bounding_box()
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    # The reasons of the headline, which are folded away, have lengths too.
    told = page.get_by_text("mm:", exact=False).locator("visible=true")
    wait_until(told.count, 20, "the value is told")
    assert "deg" in told.first.inner_text()

    page.get_by_role("tab", name="Log").click()
    # While a map is shown a click reads, it does not aim.
    assert not page.get_by_text("target", exact=False).filter(has_text="mm").count()
    page.get_by_role("tab", name="Maps").click()
    set_number(page, "View deg", 80)
    page.get_by_text("the design has changed").wait_for()
    choose(page, "Model", "traced anew each frame")
    button(page, "Measure maps").click()
    page.get_by_text("leave no light to map").first.wait_for()


def test_refused_optics_are_explained_where_they_are_set(
    tmp_path: Path, pressed_project: Path, page: Any, start_server: Start
) -> None:
    """A pinhole of 200 degrees, a colour that is none, a lamp in the wall: each told at its place.

    Undo takes the lamp back to where it was.
    """
    server = start_server(pressed_project)
    optics(page, server, pressed=True)
    set_number(page, "View deg", 200)
    page.get_by_text("outside 5 to 175 degree").first.wait_for()
    page.get_by_text("still using 100").wait_for()
    type_text(page, "LED colours", "red, bleu")
    page.get_by_text("'bleu' is not a colour").first.wait_for()
    folder(page, "LED ring")
    folder(page, "Further lights")
    button(page, "point").click()
    wait_until(lambda: "Lamp mm" in labels(page), 20, "there is a lamp")
    assert slider_value(page, "View deg") == 100
    type_numbers(page, "Lamp mm", (12.5, 0.0, 0.5))
    button(page, "Render image").click()
    refusal = page.get_by_text("the cavity ends at 12 mm there")
    # Above, beside the button, under the widget, and in the notification.
    wait_until(lambda: refusal.count() >= 4, 60, "the refusal is shown")
    page.screenshot(path=str(tmp_path / "refused.png"))
    tab(page, "Shape").click()
    button(page, "Undo").click()
    tab(page, "Optics").click()
    button(page, "Render image").click()
    wait_until(lambda: page.get_by_text("Image ✓").count(), 60, "the image is rendered")
