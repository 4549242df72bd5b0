"""A body of the designer's own: uploaded, refused with a reason, labelled by clicking."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    changed_share,
    choose,
    labels,
    open_page,
    slider_value,
    tab,
    upload,
    view,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
TINTED = 0.01
"""Share of the view that the tint of one face of the box changes at least."""


def test_bad_file_is_refused_and_a_box_becomes_a_sensor(
    tmp_path: Path, unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """A file without triangles leaves the finger; a box is built; a click labels its face."""
    import trimesh

    bad, good = tmp_path / "bad.stl", tmp_path / "brick.stl"
    bad.write_bytes(b"solid nothing\nendsolid nothing\n")
    trimesh.creation.box((30.0, 24.0, 40.0)).export(good)
    server = start_server(unpressed_project)
    open_page(page, server.url)
    page.get_by_text("Own body (STEP or STL)").click()
    upload(page, "Load outer body", bad)
    wait_until(lambda: page.get_by_text("bad.stl has no faces").count(), 60, "the refusal is shown")
    page.get_by_text("coarse · finger").first.wait_for()
    assert "Outer radius mm" in labels(page)

    upload(page, "Load outer body", good)
    page.get_by_text("brick · imported").wait_for()
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 60, "the brick is built")
    assert "Cut off below mm" in labels(page)
    assert not page.get_by_text("bad.stl has no faces").count()
    page.get_by_text("preview: direct light, dent by geometry").wait_for()
    choose(page, "Clicks label", "driven part 2")
    page.wait_for_timeout(1000)
    before = view(page)
    box = page.locator("canvas").first.bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.get_by_text("driven part 2", exact=False).filter(has_text="face").wait_for()
    page.mouse.move(box["x"] + 5, box["y"] + box["height"] - 5)
    wait_until(lambda: changed_share(before, view(page)) > TINTED, 60, "the face is tinted")
    page.get_by_text("driven part 2: blue").first.wait_for()

    other = tmp_path / "slab.stl"
    trimesh.creation.box((30.0, 30.0, 30.0)).export(other)
    upload(page, "Load outer body", other)
    page.get_by_text("slab · imported").wait_for()


def test_a_damaged_body_is_offered_a_repair_in_one_click(
    tmp_path: Path, unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """Two blocks that were not united: refused with a remesh on offer, which a click makes."""
    import trimesh

    block = trimesh.creation.box((24.0, 24.0, 20.0))
    other = block.copy()
    other.apply_translation((0.0, 0.0, 12.0))
    path = tmp_path / "pair.stl"
    trimesh.util.concatenate([block, other]).export(path)
    server = start_server(unpressed_project)
    open_page(page, server.url)
    page.get_by_text("Own body (STEP or STL)").click()
    assert not page.get_by_role("button", name="Repair and load").count()
    upload(page, "Load outer body", path)
    says = "On offer: the body is remeshed at"
    wait_until(lambda: page.get_by_text(says).count(), 150, "the repair is offered")
    page.get_by_text("coarse · finger").first.wait_for()
    page.get_by_role("button", name="Repair and load").click()
    page.get_by_text("pair · imported").wait_for(timeout=150_000)
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 150, "the body is built")
    assert not page.get_by_role("button", name="Repair and load").count()


def test_unit_asked_for_and_leds_brought_inside(
    tmp_path: Path, unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """A drum in inches is refused until its unit is chosen; its LEDs then move to fit."""
    import trimesh

    drum = trimesh.creation.cylinder(12.0 / 25.4, 20.0 / 25.4, sections=48)
    path = tmp_path / "drum.stl"
    drum.export(path)
    server = start_server(unpressed_project)
    open_page(page, server.url)
    page.get_by_text("Own body (STEP or STL)").click()
    upload(page, "Load outer body", path)
    says = "an STL does not say which"
    wait_until(lambda: page.get_by_text(says).count(), 60, "the unit is asked for")
    page.get_by_text("coarse · finger").first.wait_for()
    choose(page, "File unit", "inch")
    page.get_by_text("drum · imported").wait_for()
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 60, "the drum is built")
    tab(page, "Optics").click()
    # Cavity of 9 mm, less the LED's half diagonal and two gaps, in half millimetres.
    assert slider_value(page, "Ring radius mm") == 7.5
