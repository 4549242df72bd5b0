"""Forces of one press from finite elements, beside those of the contact solver, in a browser."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    changed_share,
    choose,
    coarse_project,
    open_page,
    tab,
    type_numbers,
    view,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]


def test_finite_elements_are_shown_beside_the_contact_solver(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """A draft is solved, its totals stand in the table, and the skin shows how far they differ."""
    server = start_server(coarse_project(tmp_path))
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    tab(page, "Forces").click()
    page.get_by_text("Sources of forces").click()
    type_numbers(page, "FEM mesh mm", [1.5])
    type_numbers(page, "FEM radius mm", [9.0])
    button(page, "Solve by finite elements").click()
    wait_until(lambda: page.get_by_text("hexahedra,").count(), 180, "finite elements are solved")
    assert page.locator("td", has_text="finite elements").count() == 1
    before = view(page)
    choose(page, "Forces from", "difference: finite elements − contact solver")
    page.get_by_text("difference of two sources").wait_for()
    wait_until(lambda: changed_share(before, view(page)) > 0.002, 30, "the skin has other colours")
    page.screenshot(path=str(tmp_path / "difference.png"))
    type_numbers(page, "FEM radius mm", [10.0])
    page.get_by_text("of an earlier design or press").wait_for()
    choose(page, "Forces from", "contact solver")
    assert "Traceback" not in server.log.read_text()
