"""Widgets of the page by the names a person reads."""

from __future__ import annotations

import contextlib
import re
import time
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

COARSE = """
name = "coarse"
family = "finger"
[meshing]
hex_mm = 0.8
[optics]
light_model = "direct"
[optics.camera]
width_px = 320
height_px = 240
[press_case.press]
frames = 2
[press_case.settings]
grid_mm = 1.0
active_radius_mm = 9.0
"""
VISIBLE_CHANGE = 24
"""Difference of grey values that an eye sees at once."""
DRAW_WHEN_LOOKED_AT = """
window.looked = false;
window.draws = 0;
const gl = WebGL2RenderingContext.prototype;
for (const name of ["clear", "drawArrays", "drawElements", "drawRangeElements",
                    "drawArraysInstanced", "drawElementsInstanced"]) {
  const real = gl[name];
  gl[name] = function (...given) {
    if (!window.looked) return;
    window.draws += 1;
    return real.apply(this, given);
  };
}
"""
"""Leaves out what software rendering takes most of both cores for, and what few tests look at."""


def wait_until(condition: Callable[[], Any], seconds: float, what: str) -> None:
    """Poll until the condition holds."""
    deadline = time.monotonic() + seconds
    while time.monotonic() < deadline:
        if condition():
            return
        time.sleep(0.2)
    raise AssertionError(f"after {seconds} s still not: {what}")


def coarse_project(tmp_path: Path, *, frames: int = 2) -> Path:
    """A project whose last session was a coarse finger, quick to press."""
    project = tmp_path / "project"
    (project / "designs").mkdir(parents=True)
    text = COARSE.replace("frames = 2", f"frames = {frames}")
    (project / "designs" / "autosave.toml").write_text(text)
    return project


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


def press(page: Any, name: str) -> None:
    """Click a button that may have to be scrolled to."""
    button(page, name).scroll_into_view_if_needed()
    button(page, name).click()


def control(page: Any, label: str) -> Any:
    """The element that a label names."""
    pattern = re.compile(rf"^\s*{re.escape(label)}\s*$")
    found = page.locator("label[for]:visible").filter(has_text=pattern).first
    return page.locator(f'[id="{found.get_attribute("for")}"]')


def switch(page: Any, label: str) -> None:
    """Tick a box, or take its tick away, once it stands: it moves while its folder opens."""
    box = control(page, label)
    places: list[Any] = []

    def stands() -> bool:
        places.append(box.bounding_box())
        return len(places) > 1 and places[-1] == places[-2]

    wait_until(stands, 20, f"{label} stands")
    ticked = box.is_checked()
    box.click(force=True)
    wait_until(lambda: box.is_checked() != ticked, 20, f"{label} is switched")


def set_number(page: Any, label: str, value: float) -> None:
    """Type a value into the box beside a slider."""
    box = control(page, label).locator("xpath=following-sibling::div//input")
    box.fill(str(value))
    box.press("Tab")


def boxes(page: Any, label: str) -> Any:
    """The input boxes beside a label, whose text and vectors have no id."""
    pattern = re.compile(rf"^\s*{re.escape(label)}\s*$")
    found = page.locator("label:visible").filter(has_text=pattern).first
    return found.locator("xpath=ancestor::*[.//input][1]").locator("input")


def type_text(page: Any, label: str, text: str) -> None:
    """Type into a line of text; the workbench reads it a moment later."""
    boxes(page, label).first.fill(text)
    page.wait_for_timeout(1500)


def type_numbers(page: Any, label: str, values: Sequence[float]) -> None:
    """Type into the boxes of a vector."""
    for number, value in enumerate(values):
        box = boxes(page, label).nth(number)
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


def choose(page: Any, label: str, option: str) -> None:
    """Take an entry of a drop-down."""
    control(page, label).click()
    page.get_by_role("option", name=option, exact=True).click()


def labels(page: Any) -> list[str]:
    """Labels of all widgets on show."""
    return [text.strip() for text in page.locator("label[for]:visible").all_inner_texts()]


def stop_first_press(page: Any) -> None:
    """A new project presses its example at once; a test that needs no press stops it."""
    button(page, "Cancel").wait_for(timeout=30_000)
    button(page, "Cancel").click()
    button(page, "Cancel").wait_for(state="hidden", timeout=15_000)


@contextlib.contextmanager
def looking(page: Any) -> Iterator[None]:
    """Draws the 3D view of the fixture `page`, which else stays as it was when last looked at."""
    page.evaluate("() => { window.draws = 0; window.looked = true; }")
    # A whole frame is drawn at once; a view at rest draws none unless it is asked.
    page.evaluate("() => window.__viserMutable.requestRender()")
    wait_until(lambda: page.evaluate("window.draws"), 60, "the view is drawn")
    yield
    page.evaluate("window.looked = false")


def view(page: Any) -> np.ndarray:
    """What the middle of the 3D view shows, shape (H, W) of grey values."""
    import cv2

    box = page.locator("canvas").first.bounding_box()
    clip = {
        "x": box["x"] + 0.1 * box["width"],
        "y": box["y"] + 0.3 * box["height"],
        "width": 0.8 * box["width"],
        "height": 0.5 * box["height"],
    }
    with looking(page):
        data = np.frombuffer(page.screenshot(clip=clip), dtype=np.uint8)
    return np.asarray(cv2.imdecode(data, cv2.IMREAD_GRAYSCALE), dtype=np.int16)


def changed_share(before: np.ndarray, after: np.ndarray) -> float:
    """Share of pixels that differ visibly between two views."""
    return float((np.abs(after - before) > VISIBLE_CHANGE).mean())


def upload(page: Any, name: str, path: Path) -> None:
    """Give a file to an upload button."""
    with page.expect_file_chooser() as chooser:
        button(page, name).click()
    chooser.value.set_files(str(path))
