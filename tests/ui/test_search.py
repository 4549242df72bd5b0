"""The page Search in a real browser: asked, started, watched, stopped, gone on with, opened.

Goals are figures of the body alone, so that a design takes a second.
"""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import boxes, button, choose, open_page, press, set_number, tab, wait_until
from workbench.project.design_toml import design_from_toml
from workbench.project.project import Project
from workbench.variants.variant_files import list_variants

pytest.importorskip("optuna")
pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
SEARCHED_S, CONFIRMED_S = 300, 600
CYLINDER = "Shape: Straight length [mm]"


def ask(page: Any) -> None:
    """The straight part and the mount may vary; little silicone, and as high as can be."""
    highest = boxes(page, "Highest").first
    before = highest.input_value()
    choose(page, "Varied parameter", CYLINDER)
    # Choosing suggests a range, which must not come over what is typed.
    wait_until(lambda: highest.input_value() != before, 20, "a range is suggested")
    for label, value in (("Lowest", 20), ("Highest", 32)):
        boxes(page, label).first.fill(str(value))
        boxes(page, label).first.press("Tab")
    press(page, "Let it vary")
    choose(page, "Varied parameter", "LED ring: mount")
    press(page, "Let it vary")
    wait_until(page.get_by_text("LED ring: mount, cavity, shell").count, 20, "choices are told")
    for figure, wanted in (
        ("Mass of the membrane [g]", "as small as can be"),
        ("Height of the body [mm]", "as large as can be"),
    ):
        choose(page, "Figure", figure)
        choose(page, "Wanted", wanted)
        press(page, "Add goal")
        told = page.get_by_text(f"goal: {figure}, {wanted}")
        wait_until(told.count, 20, "the goal is told")


def summary(project: Path) -> dict[str, Any]:
    """How the search of the project stands."""
    files = list((project / "searches").glob("*/summary.json"))
    return json.loads(files[0].read_text()) if files else {"trials": 0}


def test_a_search_is_started_watched_stopped_gone_on_with_and_its_best_opened(
    pressed_project: Path, start_server: Start, page: Any
) -> None:
    """Twelve designs in two runs; the lightest of the front becomes a variant, and stands."""
    open_page(page, start_server(pressed_project).url)
    tab(page, "Search").click()
    press(page, "Start search")
    wait_until(
        lambda: page.get_by_text(re.compile("varies nothing|no goal")).count(), 20, "refused"
    )
    ask(page)
    wait_until(lambda: page.get_by_text(f"{CYLINDER}, 20 to 32").count(), 20, "told")
    set_number(page, "Designs to compute", 12)
    press(page, "Start search")
    button(page, "Stop search").wait_for(timeout=20_000)
    wait_until(lambda: summary(pressed_project)["trials"] >= 3, SEARCHED_S, "three are computed")
    press(page, "Stop search")
    button(page, "Continue search").wait_for(timeout=60_000)
    before = summary(pressed_project)["trials"]
    assert before < 12
    press(page, "Continue search")
    ended = page.get_by_text(re.compile("Finished: "))
    wait_until(ended.count, CONFIRMED_S, "four of the front are pressed and confirmed")
    assert summary(pressed_project)["trials"] == 12

    # Every design is on the front: a longer one is heavier and higher.
    (folder,) = (pressed_project / "searches").iterdir()
    rows = json.loads((folder / "front.json").read_text())
    lengths = [row["parameters"]["design.shape.cylinder_mm"] for row in rows]
    assert len(lengths) == 12 and lengths == sorted(lengths)
    choose(page, "Design of the front", "front 01")
    press(page, "Open as variant")
    project = Project(pressed_project)
    wait_until(lambda: list_variants(project), 30, "a variant is kept")
    (name,) = list_variants(project)
    kept = (pressed_project / "variants" / f"{name}.toml").read_text()
    assert design_from_toml(kept).shape["cylinder_mm"] == lengths[0]
