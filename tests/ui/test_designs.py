"""A designer starts from a thumbnail, changes what it is made of, and keeps it under a name."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    choose,
    coarse_project,
    control,
    image_source,
    open_page,
    set_number,
    slider_value,
    switch,
    tab,
    type_text,
    wait_until,
)
from workbench.proof.benchmarks.tab import Tab

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]


def test_start_from_a_thumbnail_and_keep_it(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """Gallery, trunk, silicone, name, save, duplicate, open: files and widgets agree."""
    project = unpressed_project
    server = start_server(project)
    open_page(page, server.url)
    button(page, "Gallery of designs").click()
    page.locator('[data-name="trunk"] img').click()
    wait_until(lambda: page.get_by_text("Lobe height mm").count(), 30, "the trunk's sliders")

    page.get_by_text("Material", exact=True).first.click()
    choose(page, "Elastomer", "Dragon Skin 10 (10A)")
    wait_until(lambda: slider_value(page, "Shore A") == 10, 20, "the hardness follows")
    type_text(page, "Name", "soft trunk")
    button(page, "Save design").click()
    file = project / "designs" / "soft trunk.toml"
    wait_until(file.exists, 20, "the file is written")
    kept = tomllib.loads(file.read_text())
    assert kept["family"] == "trunk"
    assert kept["material"]["young_MPa"] == pytest.approx(0.4127, abs=5e-4)
    assert kept["casting"]["silicone"] == "Dragon Skin 10"

    button(page, "Duplicate").click()
    wait_until((project / "designs" / "soft trunk 2.toml").exists, 20, "the copy is written")
    set_number(page, "Width mm", 40)
    button(page, "Gallery of designs").click()
    page.locator('[data-name="soft trunk (yours)"]').click()
    wait_until(lambda: slider_value(page, "Width mm") == 35, 20, "the kept design is open")


def test_an_image_preview_follows_the_sliders(
    pressed_project: Path, page: Any, start_server: Start
) -> None:
    """Shape, light and depth each change the preview; an undo brings the rendered image back."""
    server = start_server(pressed_project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    rendered = image_source(page)
    set_number(page, "Straight length mm", 24)
    wait_until(lambda: page.get_by_text("dent by geometry").count(), 60, "the preview is shown")
    seen = [rendered, image_source(page)]
    tab(page, "Optics").click()
    set_number(page, "LED height mm", 6)
    wait_until(lambda: image_source(page) not in seen, 30, "the preview follows the light")
    seen.append(image_source(page))
    tab(page, "Simulate").click()
    set_number(page, "Depth mm", 1.6)
    wait_until(lambda: image_source(page) not in seen, 30, "the preview follows the depth")
    page.locator("canvas").first.focus()
    for _ in range(3):
        page.keyboard.press("Control+z")
        page.wait_for_timeout(300)
    wait_until(lambda: not page.get_by_text("dent by geometry").count(), 30, "the image is back")


def test_results_follow_by_themselves_once_edits_settle(
    pressed_project: Path, page: Any, start_server: Start
) -> None:
    """With Auto update two edits end in one fresh image, without a button."""
    server = start_server(pressed_project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    switch(page, "Auto update")
    set_number(page, "Straight length mm", 24)
    set_number(page, "Elastomer mm", 2.4)
    wait_until(lambda: page.get_by_text("Image ○").count(), 20, "the image is stale")
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the image follows by itself")


def test_objects_are_chosen_from_thumbnails(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """A click on the cube's thumbnail makes it the object, under its label."""
    server = start_server(unpressed_project)
    open_page(page, server.url)
    tab(page, "Simulate").click()
    button(page, "Gallery of objects").click()
    page.locator('[data-name="cube"] img').click()
    wait_until(lambda: "cube" in control(page, "Object shape").input_value(), 20, "the cube")


def test_saving_over_another_design_asks(tmp_path: Path, start_server: Start) -> None:
    """A file that this session neither opened nor saved stays; its own is saved over silently."""
    project = coarse_project(tmp_path)
    other = (project / "designs" / "autosave.toml").read_text().replace("0.8", "0.7")
    (project / "designs" / "coarse.toml").write_text(other)
    server = start_server(project)
    with Tab(server.url) as page:
        page.uuid("Saved design")
        page.trigger("Save design")
        page.click("Keep both")
        copy = project / "designs" / "coarse 2.toml"
        wait_until(copy.exists, 20, "the copy is written")
        page.wait(lambda: page.value("Name") == "coarse 2", 20, "one goes on with the copy")
        assert (project / "designs" / "coarse.toml").read_text() == other
        page.set("Elastomer mm", 2.6)
        wait_until(lambda: _saved_again(page, copy), 20, "its own file is replaced without asking")
        page.set("Saved design", "coarse")
        delete_and_bring_back(page, project / "designs" / "coarse.toml")


def _saved_again(page: Tab, file: Path) -> bool:
    page.trigger("Save design")
    return "elastomer_mm = 2.6" in file.read_text()


def delete_and_bring_back(page: Tab, file: Path) -> None:
    """Delete the chosen design, then undo that."""
    text = file.read_text()
    page.set("With it", "Delete")
    wait_until(lambda: not file.exists(), 20, "it is in the trash")
    page.click("Bring deleted design back")
    wait_until(file.exists, 20, "it is back")
    assert file.read_text() == text
