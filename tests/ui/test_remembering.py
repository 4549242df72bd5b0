"""What a page remembers is put back once, and never over what a hand has chosen meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import open_page, tab, wait_until
from ui.patches.remembering import STAND_MS, STORED, remember

pytestmark = [pytest.mark.ui, pytest.mark.slow]

BACK = "Boolean(window.keptDocks && window.keptDocks.back)"
SLOWER = 8
"""So many times as long docks are looked at: a hand comes before they stand, on any machine."""
SLOW = f"""
window.puts = 0;
const later = window.setTimeout, read = Storage.prototype.getItem;
window.setTimeout = (what, ms, ...given) =>
  later(what, ms === {STAND_MS} ? {SLOWER} * ms : ms, ...given);
Storage.prototype.getItem = function (name) {{
  if (name === '{STORED}') window.puts += 1;
  return read.call(this, name);
}};
"""
FORCES = f"""localStorage.setItem('{STORED}', '{{"tabs": ["Optics", "Forces"]}}');"""


def chosen(page: Any, name: str) -> bool:
    return tab(page, name).get_attribute("aria-selected") == "true"


def test_it_is_put_back_once_however_often_the_script_is_laid(
    unpressed_project: Path, page: Any, start_server: Callable[..., Server]
) -> None:
    """The page lays it as its docks come; a second putting back would undo what was chosen."""
    page.add_init_script(SLOW + FORCES)
    open_page(page, start_server(unpressed_project).url)
    # One more, as from a dock that is laid out anew.
    page.evaluate(remember())
    wait_until(lambda: page.evaluate(BACK), 60, "the docks stand")
    page.wait_for_timeout(2 * SLOWER * STAND_MS)
    assert page.evaluate("window.puts") == 1
    assert chosen(page, "Optics") and chosen(page, "Forces")


def test_what_a_hand_has_chosen_before_the_docks_stand_stays(
    unpressed_project: Path, page: Any, start_server: Callable[..., Server]
) -> None:
    """It is also what the page remembers from then on."""
    page.add_init_script(SLOW + FORCES)
    open_page(page, start_server(unpressed_project).url)
    tab(page, "Maps").click()
    assert not page.evaluate(BACK), "the docks stood before"
    wait_until(lambda: page.evaluate(BACK), 60, "the docks stand")
    page.wait_for_timeout(1000)
    assert chosen(page, "Maps") and not chosen(page, "Forces")
    assert "Maps" in page.evaluate(f"localStorage.getItem('{STORED}')")
