"""A designer's whole task in one sitting, and a walk of fifty edits and back."""

from __future__ import annotations

import io
import json
import random
import re
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    choose,
    coarse_project,
    open_page,
    press,
    set_number,
    slider_value,
    stop_first_press,
    tab,
    type_numbers,
    type_text,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
SEED = 20261122
EDITS = 50
WALK = {
    "Shape": {
        "Outer radius mm": (12.0, 18.0),
        "Straight length mm": (15.0, 35.0),
        "Tip ratio": (0.8, 1.2),
        "Elastomer mm": (1.5, 3.0),
    },
    "Optics": {
        "LED height mm": (3.0, 7.0),
        "First LED deg": (0.0, 360.0),
        "LED power": (0.5, 2.0),
    },
    "Simulate": {"Depth mm": (0.2, 2.0), "Frames": (1, 9), "Twist deg": (-30.0, 30.0)},
}
"""Sliders of the walk by tab, and the span of their values: most edits hold, some are refused."""


def fresh(page: Any, stage: str) -> None:
    """Until a stage is up to date."""
    wait_until(lambda: page.get_by_text(f"{stage} ✓").count(), 180, f"{stage} is up to date")


def downloaded(page: Any, name: str) -> bytes:
    """What a download button gives."""
    with page.expect_download(timeout=60_000) as download:
        press(page, name)
    return Path(download.value.path()).read_bytes()


def save(page: Any, name: str) -> None:
    """Keep the pressed design as a variant."""
    tab(page, "Compare").click()
    type_text(page, "Variant name", name)
    press(page, "Save variant")


def test_from_a_preset_to_a_report_and_a_mould(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """Trunk, lobes, LEDs, bake, press, variant, wall, press, compare, report, mould: all files."""
    project = coarse_project(tmp_path)
    server = start_server(project, cold=True)
    open_page(page, server.url)
    stop_first_press(page)
    choose(page, "Start from", "trunk")
    set_number(page, "Lobe height mm", 7)
    fresh(page, "Shape")
    tab(page, "Optics").click()
    set_number(page, "LED height mm", 4)
    type_numbers(page, "Photons", [400_000])
    tab(page, "Simulate").click()
    set_number(page, "Frames", 2)
    page.get_by_text("Solver", exact=True).first.click()
    set_number(page, "Grid mm", 1.0)
    tab(page, "Optics").click()
    press(page, "Render image")
    fresh(page, "Image")
    assert page.get_by_text("Light ✓").count() and page.get_by_text("Contact ✓").count()
    save(page, "thin")
    wait_until((project / "variants" / "thin.toml").exists, 20, "the variant is kept")

    tab(page, "Shape").click()
    set_number(page, "Elastomer mm", 3)
    wait_until(lambda: page.get_by_text("Image ○").count(), 20, "the image is stale")
    press(page, "Update results")
    fresh(page, "Image")
    save(page, "thick")
    wait_until((project / "variants" / "thick.toml").exists, 20, "the variant is kept")
    row = page.locator("tr", has_text="elastomer").first
    row.wait_for()
    assert {"2.5", "3"} <= set(row.inner_text().split())
    report = downloaded(page, "Export comparison (HTML)").decode()
    assert report.count("data:image/") >= 4 and "thin" in report and "thick" in report
    assert not re.search(r"(src|href)=['\"]https?:", report)

    tab(page, "Make").click()
    press(page, "Make parts")
    button(page, "Download part STL").wait_for(timeout=180_000)
    names = zipfile.ZipFile(io.BytesIO(downloaded(page, "Download all (zip)"))).namelist()
    assert any(name.endswith(".stl") for name in names)
    assert any(name.endswith(".step") for name in names)
    assert any("sheet" in name for name in names)


def edit_at_random(page: Any, rng: random.Random) -> list[tuple[str, float]]:
    """Fifty values typed into sliders of three tabs; which, to be told when it fails."""
    done = []
    for _ in range(EDITS):
        name = rng.choice(list(WALK))
        label, (low, high) = rng.choice(list(WALK[name].items()))
        value = rng.randint(int(low), int(high)) if label == "Frames" else rng.uniform(low, high)
        tab(page, name).click()
        set_number(page, label, round(value, 2))
        done.append((label, round(value, 2)))
    return done


def test_fifty_edits_and_back(unpressed_project: Path, page: Any, start_server: Start) -> None:
    """Undo to the end gives the first design byte for byte, redo to the end the last one.

    The downloaded file is compared, and the widgets show what it says.
    """
    server = start_server(unpressed_project)
    open_page(page, server.url)
    page.get_by_text("Design files", exact=True).first.click()
    first = downloaded(page, "Download design")
    done = edit_at_random(page, random.Random(SEED))
    tab(page, "Shape").click()
    last = downloaded(page, "Download design")
    assert last != first, json.dumps(done)
    for key, wanted in (("Control+z", first), ("Control+Shift+Z", last), ("Control+z", first)):
        for _ in range(EDITS + 5):
            page.keyboard.press(key)
            page.wait_for_timeout(60)
        page.wait_for_timeout(2_000)
        assert downloaded(page, "Download design") == wanted, (key, json.dumps(done))
    assert slider_value(page, "Elastomer mm") == 2.0
    fresh(page, "Shape")
