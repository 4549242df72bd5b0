"""What tasks found of two variants, in a real browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    coarse_project,
    open_page,
    press,
    set_number,
    tab,
    type_text,
    wait_until,
)
from tests.unit.test_told_apart import LOST, SURE
from workbench.project.project import Project
from workbench.variants.kept_tasks import keep
from workbench.variants.variant_files import list_variants
from workbench.variants.variants import load_variant

pytestmark = [pytest.mark.ui, pytest.mark.slow]


def test_results_of_both_variants_stand_beside_each_other(
    tmp_path: Path, page: Any, start_server: Callable[..., Server]
) -> None:
    """Without results it says the command; with them scores, and which object only B takes."""
    folder = coarse_project(tmp_path)
    server = start_server(folder)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Shape ✓").count(), 60, "the shape is built")
    tab(page, "Compare").click()
    type_text(page, "Variant name", "thin")
    _save(page, folder, "thin")
    page.get_by_text("What they tell apart", exact=True).click()
    page.get_by_text("Choose A and B.").last.wait_for()
    tab(page, "Shape").click()
    set_number(page, "Elastomer mm", 3)
    tab(page, "Compare").click()
    type_text(page, "Variant name", "thick")
    _save(page, folder, "thick")
    page.get_by_text("No task was run on thin.").wait_for()
    assert page.get_by_text("task objects").first.is_visible()

    project = Project(folder)
    for name, result in (("thin", SURE), ("thick", LOST)):
        keep(project, load_variant(project, name).state.design, result)
    press(page, "Swap A and B")
    page.get_by_text("Only A takes").wait_for()
    press(page, "Swap A and B")
    page.get_by_text("Only B takes").wait_for()
    row = page.locator("tr", has_text="accuracy")
    assert row.first.inner_text().split()[:5] == ["objects", "accuracy", "0.95", "±", "0.1"]
    assert row.first.inner_text().split()[-1] == "A"


def _save(page: Any, folder: Path, name: str) -> None:
    """Save a variant; refused while its shape is being built, which a loaded machine takes long
    for, and the words for a built shape may still be those of the shape before."""

    def saved() -> bool:
        press(page, "Save variant")
        page.wait_for_timeout(1000)
        return name in list_variants(Project(folder))

    wait_until(saved, 60, f"{name} is saved")
