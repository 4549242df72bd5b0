"""What is done on the page before each screenshot of README and tutorial, in their order."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2  # noqa: TID253 (a program of its own, not part of the package)
import numpy as np

from docs.page_shots import LONG_S, SIZE, command, fresh, number, pressed, shoot, tick
from docs.photo_set import photo_set
from tests.ui.page_faults import quiet
from tests.ui.widgets import (
    button,
    choose,
    control,
    press,
    set_number,
    slider_value,
    tab,
    type_text,
    upload,
    wait_until,
)


def first(page: Any) -> None:
    """The first screen: the finger, pressed."""
    tab(page, "Shape").click()
    shoot(page, "first")


def gallery(page: Any) -> None:
    """All designs as thumbnails."""
    tab(page, "Shape").click()
    press(page, "Gallery of designs")
    shoot(page, "gallery")
    button(page, "Close").first.click()
    page.get_by_text("Choose", exact=True).first.wait_for(state="hidden")
    page.wait_for_timeout(1_000)


def preview(page: Any) -> None:
    """Body and preview of the image while a slider moves; then back."""
    tab(page, "Shape").click()
    quiet(page)
    box = control(page, "Elastomer mm").bounding_box()
    y = box["y"] + box["height"] * 0.35
    # From 2.0 to some 1.5 mm, as the tutorial says, on a slider from 0.8 to 6 mm.
    page.mouse.move(box["x"] + 0.231 * box["width"], y)
    page.mouse.down()
    page.mouse.move(box["x"] + 0.165 * box["width"], y, steps=12)
    page.wait_for_timeout(6_000)
    shoot(page, "preview", aside=False)
    page.mouse.up()
    # A press may have been aimed anew, which is a step of its own.
    while slider_value(page, "Elastomer mm") != 2.0 or not page.get_by_text("Image ✓").count():
        press(page, "Undo")
        page.wait_for_timeout(5_000)


def section(page: Any) -> None:
    """The finger cut open, and the thickness of its wall measured."""
    tab(page, "View").click()
    set_number(page, "Frame", 0)
    button(page, "Front").click()
    tick(page, "Section")
    page.wait_for_timeout(6_000)
    press(page, "Measure distance")
    x, y = wall(page)
    page.mouse.click(x - 1, y)
    page.get_by_text("Click the second point").wait_for()
    page.mouse.click(x + 16, y)
    page.get_by_text("Click the second point").wait_for(state="hidden")
    shoot(page, "section")
    page.keyboard.press("Escape")
    tick(page, "Section")
    set_number(page, "Frame", 6)
    button(page, "Isometric").click()


def wall(page: Any) -> tuple[float, float]:
    """A pixel on the outer left edge of what the middle of the view shows."""
    box = page.locator("canvas").first.bounding_box()
    grey = cv2.imdecode(np.frombuffer(page.screenshot(), dtype=np.uint8), cv2.IMREAD_GRAYSCALE)
    assert grey is not None
    row = int(box["y"] + 0.55 * box["height"])
    line = grey[row, 420 : SIZE["width"] - 380].astype(int)
    edge = int(np.flatnonzero(np.abs(line - line[0]) > 25)[0])
    return 420.0 + edge + 3, float(row)


def optics(page: Any) -> None:
    """LEDs and camera with their handles."""
    tab(page, "Optics").click()
    for label in ("Ring handle", "Camera handle"):
        tick(page, label)
    # The pressed skin is opaque; the one at rest shows what is inside.
    set_number(page, "Frame", 0)
    tab(page, "View").click()
    page.get_by_text("Show and fade", exact=True).first.click()
    for label in ("Skin opacity %", "Support opacity %"):
        set_number(page, label, 15)
    shoot(page, "optics")
    for label, percent in (("Skin opacity %", 55), ("Support opacity %", 12)):
        set_number(page, label, percent)
    for label in ("Ring handle", "Camera handle"):
        tick(page, label)
    set_number(page, "Frame", 6)


def contact(page: Any) -> None:
    """Pressure on the skin with arrows of force, and the curve beside it."""
    tab(page, "Simulate").click()
    tab(page, "Forces").click()
    page.keyboard.press("4")
    tab(page, "Skin").click()
    choose(page, "Colours", "pressure")
    for label in ("Force arrows", "Hide object"):
        tick(page, label)
    page.mouse.move(720, 300)
    for _ in range(2):
        page.mouse.wheel(0, -500)
        page.wait_for_timeout(300)
    shoot(page, "contact")
    for label in ("Force arrows", "Hide object"):
        tick(page, label)
    choose(page, "Colours", "displacement")
    tab(page, "Timeline").click()
    page.keyboard.press("5")


def maps(page: Any) -> None:
    """How well the skin is seen, on the skin."""
    tab(page, "Maps").click()
    press(page, "Measure maps")
    fresh(page, "Maps")
    shoot(page, "maps")
    tick(page, "Show on the skin")
    tab(page, "Tactile image").click()


def calibrate(page: Any) -> None:
    """Photographs of a built finger, a contact found in one, and the design over the idle photo."""
    tab(page, "Calibrate").click()
    with tempfile.TemporaryDirectory() as folder:
        upload(page, "Load photographs", photo_set(Path(folder)))
        found = page.get_by_text(re.compile(r"Contact found: [\d.]+ px")).locator("visible=true")
        wait_until(found.count, LONG_S, "contacts are found")
    control(page, "Photo").scroll_into_view_if_needed()
    page.mouse.move(200, 500)
    page.mouse.wheel(0, 260)
    shoot(page, "calibrate")


def compare(page: Any) -> None:
    """Two walls: variants, score card, both in the view."""
    tab(page, "Compare").click()
    keep(page, "thick")
    tab(page, "Shape").click()
    set_number(page, "Elastomer mm", 1.5)
    pressed(page)
    tab(page, "Compare").click()
    keep(page, "thin")
    tick(page, "Show B in 3D")
    page.get_by_text("A against B", exact=True).first.scroll_into_view_if_needed()
    page.mouse.move(200, 500)
    page.mouse.wheel(0, -260)
    shoot(page, "compare")
    tick(page, "Show B in 3D")


def keep(page: Any, name: str) -> None:
    """Save a variant."""
    type_text(page, "Variant name", name)
    press(page, "Save variant")
    page.wait_for_timeout(4_000)


def sweep(page: Any) -> None:
    """A figure against the wall."""
    tab(page, "Compare").click()
    choose(page, "Parameter", "Layers: elastomer [mm]")
    # The program suggests a span a moment later.
    page.wait_for_timeout(2_000)
    for label, value in (("From", 1.5), ("To", 2.3)):
        number(page, label, value)
    set_number(page, "Steps", 3)
    press(page, "Run sweep")
    wait_until(lambda: page.get_by_text("Finished: 3 points.").count(), LONG_S, "the sweep is done")
    button(page, "Run sweep").scroll_into_view_if_needed()
    page.mouse.move(200, 500)
    page.mouse.wheel(0, 420)
    shoot(page, "sweep")


def make(page: Any) -> None:
    """The mould, exploded, with its checks."""
    tab(page, "Make").click()
    press(page, "Make parts")
    wait_until(lambda: button(page, "Download part STL").count(), LONG_S, "the parts are made")
    quiet(page)
    page.keyboard.press("f")
    page.get_by_text("Checks", exact=True).first.scroll_into_view_if_needed()
    shoot(page, "make")


def help_pages(page: Any) -> None:
    """Help of a panel, the keyboard map and the tour."""
    press(page, "Help: Make")
    shoot(page, "help")
    page.keyboard.press("Escape")
    page.wait_for_timeout(1_000)
    page.keyboard.press("h")
    shoot(page, "keys")
    page.keyboard.press("Escape")
    page.wait_for_timeout(1_000)
    press(page, "Back to the sensor")
    quiet(page)
    command(page, "Tour")
    shoot(page, "tour")
    page.keyboard.press("Escape")


STEPS: dict[str, Callable[[Any], None]] = {
    "first": first,
    "gallery": gallery,
    "preview": preview,
    "section": section,
    "optics": optics,
    "contact": contact,
    "maps": maps,
    "calibrate": calibrate,
    "compare": compare,
    "sweep": sweep,
    "make": make,
    "help": help_pages,
}
