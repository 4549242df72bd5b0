"""The page Read in a real browser: from photographs of a touched pad to depth, force and a profile.

The photographs are rendered by the program itself: a comparison with itself.
"""

from __future__ import annotations

import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

import workbench as wb
from tests.photographed_pad import photographed_pad
from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    control,
    open_page,
    press,
    slider_value,
    tab,
    type_text,
    upload,
    wait_until,
)
from ui.panels.read.intake import EMPTY
from ui.panels.read.running import OVER
from workbench.project.design_toml import design_to_toml

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
SIZE_PX = (160, 120)
DEPTH_MM = 0.8
OPENED_S = 120


def design() -> wb.Design:
    """A small flat pad in a coarse mesh, seen by a small camera, with few photons."""
    return photographed_pad(*SIZE_PX, 100_000).replace("meshing.hex_mm", 0.8)


@pytest.fixture(scope="module")
def images() -> np.ndarray:
    """The untouched pad and a ball that comes, (1 + K, H, W, 3), uint8."""
    top_mm = float(wb.evaluate(design()).mesh.outer.points_mm[:, 2].max())
    motion = wb.Press(target_mm=(1.0, 0.5, top_mm), depth_mm=DEPTH_MM, frames=3)
    settings = wb.ContactSettings(grid_mm=1.0)
    return wb.evaluate(design(), wb.Indenter(size_mm=6.0), motion, settings=settings).images


def png(rgb: np.ndarray) -> bytes:
    return cv2.imencode(".png", rgb[:, :, ::-1])[1].tobytes()


def says(page: Any, text: str | re.Pattern[str]) -> Callable[[], int]:
    return lambda: page.get_by_text(text).locator("visible=true").count()


def depth_mm(page: Any) -> float:
    """The depth that the page tells."""
    told = page.get_by_text(re.compile("mm deep")).locator("visible=true").inner_text()
    return float(told.partition(" mm deep")[0].split()[-1])


def test_from_photographs_to_what_touched_the_sensor(
    images: np.ndarray, tmp_path: Path, start_server: Start, page: Any
) -> None:
    """Refused without an idle photo and in another size; read, drawn on, followed as a video."""
    project = tmp_path / "project"
    (project / "designs").mkdir(parents=True)
    (project / "designs" / "autosave.toml").write_text(design_to_toml(design()))
    video = cv2.VideoWriter(
        str(project / "touch.avi"), cv2.VideoWriter.fourcc(*"FFV1"), 10.0, SIZE_PX
    )
    for image in images:
        video.write(np.ascontiguousarray(image[:, :, ::-1]))
    video.release()
    server = start_server(project)
    open_page(page, server.url)
    tab(page, "Read").click()
    if button(page, "Cancel").count():
        button(page, "Cancel").click()
    wait_until(says(page, EMPTY.split("`")[0].strip()), 20, "an empty page says what to do")

    press_photo, small = tmp_path / "p1.png", tmp_path / "small.png"
    press_photo.write_bytes(png(images[-1]))
    upload(page, "Load photos to read", press_photo)
    wait_until(says(page, "photographs of touch"), 20, "it came")
    press(page, "Read photo")
    wait_until(says(page, re.compile("there is no idle photo")), 20, "an idle photo is missing")

    archive = tmp_path / "set.zip"
    with zipfile.ZipFile(archive, "w") as file:
        file.writestr("set/idle.png", png(images[0]))
        file.writestr("set/p1.png", png(images[-1]))
    upload(page, "Load photos to read", archive)
    wait_until(says(page, re.compile("and the idle photo")), 20, "idle came")
    small.write_bytes(png(images[-1][::2, ::2]))
    upload(page, "Load photos to read", small)
    wait_until(says(page, re.compile("80 x 60 pixels")), 20, "another size is refused")

    press(page, "Read photo")
    wait_until(says(page, re.compile("mm deep")), OPENED_S, "it is read")
    assert depth_mm(page) == pytest.approx(DEPTH_MM, abs=0.15)
    wait_until(says(page, re.compile("ball of radius")), 5, "a ball is fitted")
    found = np.load(project / "reading" / "out" / "p1.npz")
    assert np.nanmax(found["depth_mm"]) == pytest.approx(DEPTH_MM, abs=0.15)

    picture = control(page, "Look at reading").locator(
        "xpath=ancestor::*[.//img[starts-with(@src,'blob:')]][1]"
    )
    picture = picture.locator("img[src^='blob:']:visible").first
    picture.scroll_into_view_if_needed()
    box = picture.bounding_box()
    page.mouse.move(box["x"] + 0.251 * box["width"], box["y"] + 0.252 * box["height"])
    page.mouse.down()
    page.mouse.move(box["x"] + 0.751 * box["width"], box["y"] + 0.502 * box["height"], steps=5)
    page.mouse.up()
    wait_until(lambda: slider_value(page, "To column px") == 120, 20, "the line is drawn")
    assert slider_value(page, "From column px") == 40
    assert slider_value(page, "From row px") == 30
    assert slider_value(page, "To row px") == 60

    page.get_by_text("From a camera", exact=True).click()
    type_text(page, "Camera or video", "touch.avi")
    press(page, "Follow camera")
    wait_until(says(page, OVER), OPENED_S, "the video ends")
    assert says(page, re.compile(r"touch\.avi:"))()
    assert depth_mm(page) == pytest.approx(DEPTH_MM, abs=0.15)
