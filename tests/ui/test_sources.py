"""Forces of one press by finite elements and by a network, beside the contact solver's."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.made_weights import card_of, tiny_weights, write_tiny
from tests.ui.conftest import Server
from tests.ui.widgets import (
    button,
    changed_share,
    choose,
    open_page,
    press,
    set_number,
    tab,
    type_numbers,
    view,
    wait_until,
)
from workbench.project.design_toml import design_from_toml

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]


def test_finite_elements_are_shown_beside_the_contact_solver(
    tmp_path: Path, pressed_project: Path, page: Any, start_server: Start
) -> None:
    """A draft is solved, its totals stand in the table, and the skin shows how far they differ."""
    server = start_server(pressed_project)
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


def add_weights(project: Path, *, there: bool = True) -> Path:
    """Give the coarse finger a tiny network that knows it, in its folder or gone from there."""
    autosave = project / "designs" / "autosave.toml"
    text = autosave.read_text()
    card = card_of(design_from_toml(text), hex_mm=1.5, grid_mm=1.0)
    # 5 mN downward at each of some two thousand vertices.
    path = write_tiny(project / "weights", tiny_weights((0.0, 0.0, -5e-3), card=card))
    autosave.write_text(f'{text}[press_case.learned]\nweights = "weights/{path.name}"\n')
    if not there:
        path.unlink()
    return project


def test_a_network_predicts_what_it_knows_and_says_what_it_does_not(
    tmp_path: Path, pressed_project: Path, page: Any, start_server: Start
) -> None:
    """The known press by itself; a deeper one when asked, with a doubt in the panel and a badge."""
    server = start_server(add_weights(pressed_project))
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    tab(page, "Forces").click()
    page.get_by_text("Sources of forces").click()
    learned = page.locator("td", has_text="learned")
    wait_until(learned.count, 60, "the press is predicted unasked")
    assert page.get_by_text("Not known to the network").count() == 0
    before = view(page)
    choose(page, "Forces from", "learned")
    page.get_by_text("by the network, scale of all frames").wait_for()
    assert page.get_by_text("doubtful").count() == 0
    tab(page, "Skin").click()
    choose(page, "Colours", "pressure")
    wait_until(lambda: changed_share(before, view(page)) > 0.002, 30, "the skin has other colours")
    choose(page, "Colours", "von Mises stress")
    tab(page, "Timeline").click()
    page.get_by_text("not given by this source").wait_for()
    tab(page, "Simulate").click()
    set_number(page, "Depth mm", 1.3)
    page.get_by_text("learned forces are of an earlier design or press").wait_for()
    press(page, "Predict by the network")
    doubt = page.get_by_text("the press is 1.3 mm deep, trained to 1 mm")
    wait_until(doubt.count, 180, "what the network does not know is said")
    choose(page, "Forces from", "difference: learned − contact solver")
    page.get_by_text("doubtful").wait_for()
    page.screenshot(path=str(tmp_path / "doubtful.png"))
    assert "Traceback" not in server.log.read_text()


def test_weights_that_are_gone_are_told_beside_the_button(
    pressed_project: Path, page: Any, start_server: Start
) -> None:
    """The file was there when the design was saved: a message with a remedy, and all else works."""
    server = start_server(add_weights(pressed_project, there=False))
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Image ✓").count(), 180, "the example is pressed")
    tab(page, "Forces").click()
    page.get_by_text("Sources of forces").click()
    press(page, "Predict by the network")
    told = page.get_by_text("Choose other weights, or put the file into the project's folder")
    wait_until(told.count, 60, "it is said that the weights cannot be read")
    assert "Traceback" not in server.log.read_text()
