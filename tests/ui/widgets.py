"""Widgets of the page by the names a person reads."""

from __future__ import annotations

import re
from typing import Any


def open_page(page: Any, url: str) -> None:
    """Open the workbench and wait until it can be used; few pixels, for software rendering."""
    page.goto(f"{url}/?fixedDpr=0.4")
    tab(page, "Shape").wait_for()


def tab(page: Any, name: str) -> Any:
    """A tab of a panel."""
    return page.locator('[role="tab"]').filter(has_text=re.compile(rf"^{re.escape(name)}$"))


def button(page: Any, name: str) -> Any:
    """A button by its text."""
    return page.get_by_role("button", name=name, exact=True)


def control(page: Any, label: str) -> Any:
    """The element that a label names."""
    pattern = re.compile(rf"^\s*{re.escape(label)}\s*$")
    found = page.locator("label[for]:visible").filter(has_text=pattern).first
    return page.locator(f'[id="{found.get_attribute("for")}"]')


def set_number(page: Any, label: str, value: float) -> None:
    """Type a value into the box beside a slider."""
    box = control(page, label).locator("xpath=following-sibling::div//input")
    box.fill(str(value))
    box.press("Tab")


def slider_value(page: Any, label: str) -> float:
    """What a slider shows."""
    thumb = control(page, label).locator('[role="slider"]')
    return float(thumb.get_attribute("aria-valuenow"))


def drag(page: Any, label: str, start: float, stop: float) -> None:
    """Drag a slider's thumb between two shares of its length."""
    box = control(page, label).bounding_box()
    across, y = box["width"], box["y"] + box["height"] * 0.35
    page.mouse.move(box["x"] + start * across, y)
    page.mouse.down()
    page.mouse.move(box["x"] + stop * across, y, steps=12)
    page.mouse.up()


def image_source(page: Any, number: int = 0) -> str:
    """Address of an image in the right dock; it changes when the image does."""
    return page.locator("img:visible").nth(number).get_attribute("src")
