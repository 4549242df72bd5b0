"""How many clicks and entries the main job takes, counted on the page."""

from __future__ import annotations

import io
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    control,
    open_page,
    press,
    set_number,
    slider_value,
    tab,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
MOST = 12
FIT = "Fit LEDs and camera to the body"


class Hand:
    """Does what a designer does, and counts: a click, or a value with the key that ends it."""

    def __init__(self, page: Any) -> None:
        self.page = page
        self.done: list[str] = []

    def press(self, name: str) -> None:
        press(self.page, name)
        self.done.append(name)

    def open(self, name: str) -> None:
        tab(self.page, name).click()
        self.done.append(f"tab {name}")

    def enter(self, label: str, value: float) -> None:
        set_number(self.page, label, value)
        wait_until(lambda: slider_value(self.page, label) == value, 20, f"{label} is {value}")
        self.done.append(f"{label} {value:g}")

    def choose(self, label: str, option: str) -> None:
        """Two clicks: the list, and its entry."""
        control(self.page, label).click()
        self.page.get_by_role("option", name=option, exact=True).click()
        self.done += [label, option]

    def touch(self) -> None:
        """A click on the side of the body, which stands in the middle of the view."""
        box = self.page.locator("canvas").first.bounding_box()
        place = box["x"] + box["width"] / 2, box["y"] + 0.45 * box["height"]
        self.page.mouse.click(*place)
        self.done.append("click on the skin")


def test_a_thin_finger_from_the_first_page_to_its_mould(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """12 mm thin, 8 LEDs, pressed at the side, its image, its mould as a zip: 12 at most."""
    server = start_server(unpressed_project)
    open_page(page, server.url)
    page.get_by_text("Shape ✓").wait_for()
    hand = Hand(page)
    hand.choose("Start from", "finger")
    hand.enter("Outer radius mm", 6)
    button(page, FIT).wait_for()
    hand.press(FIT)
    hand.open("Optics")
    hand.enter("LEDs", 8)
    hand.touch()
    page.get_by_text("The press aims elsewhere").first.wait_for()
    hand.press("Update results")
    hand.open("Make")
    with page.expect_download(timeout=200_000) as download:
        hand.press("Download all (zip)")
    print(f"{len(hand.done)} clicks and entries: {', '.join(hand.done)}")
    assert len(hand.done) <= MOST
    page.get_by_text("Image ✓").wait_for(timeout=200_000)
    with zipfile.ZipFile(io.BytesIO(Path(download.value.path()).read_bytes())) as files:
        assert any(name.endswith(".stl") and "mould" in name for name in files.namelist())
