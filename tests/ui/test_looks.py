"""On no page of a small laptop do widgets overlap, is text cut or too faint to read."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.ui.axe import axe_faults, axe_script
from tests.ui.conftest import Server
from tests.ui.page_faults import Fault, faults, places, unfold
from tests.ui.warm_start import WarmStart
from tests.ui.widgets import DRAW_WHEN_LOOKED_AT, coarse_project, open_page, tab, wait_until
from ui.page.theme import DARK, STORED
from ui.patches.remembering import STORED as KEPT

pytestmark = [pytest.mark.ui, pytest.mark.slow]

BROKEN = """
<body style="background:#fff">
<div style="position:absolute;left:0;top:0;width:60px;overflow:hidden;white-space:nowrap">
a label that is too long for its box</div>
<button style="position:absolute;left:0;top:100px;width:90px;height:30px">left</button>
<button style="position:absolute;left:80px;top:100px;width:90px;height:30px">right</button>
<p style="position:absolute;left:0;top:200px;color:#999;font-size:14px">grey on white</p>
<p style="position:absolute;left:0;top:300px;color:#333;font-size:14px">dark on white</p>
</body>
"""


@pytest.fixture(scope="module")
def found(
    browser: Any,
    warm: WarmStart,
    pressed_store: Path,
    tmp_path_factory: pytest.TempPathFactory,
) -> Iterator[list[tuple[str, Fault]]]:
    """Faults of every tab with all its folders open, with the tab's name."""
    project = coarse_project(tmp_path_factory.mktemp("looks"))
    shutil.copytree(pressed_store, project / "store")
    with Server(project, warm=warm) as server:
        page = browser.new_page(viewport={"width": 1280, "height": 720}, color_scheme="dark")
        page.add_init_script(DRAW_WHEN_LOOKED_AT)
        open_page(page, server.url)
        page.get_by_text("Image ✓").wait_for()
        rows, script = [], axe_script()
        for name in places(page):
            unfold(page)
            rows += [(name, fault) for fault in faults(page)]
            if script is not None:
                rows += [(name, fault) for fault in axe_faults(page, script)]
        yield rows
        page.close()


def of_kind(found: list[tuple[str, Fault]], kind: str) -> list[str]:
    """Faults of a kind, with the tab's name."""
    return [f"{name}: {fault.what} ({fault.more})" for name, fault in found if fault.kind == kind]


def test_faults_of_a_broken_page_are_found(page: Any) -> None:
    """One label cut, one pair of buttons 10 px over each other, one text of contrast 2.85."""
    page.set_content(BROKEN)
    rows = faults(page)
    assert [f.what for f in rows if f.kind == "cut"] == ["a label that is too long for its box"]
    assert ("left / right", "10 x 30 px") in [(f.what, f.more) for f in rows if f.kind == "overlap"]
    # (1 + .05) / (L + .05) with L = ((.6 + .055) / 1.055)^2.4, by WCAG 2.
    faint = [(fault.what, fault.more) for fault in rows if fault.kind == "contrast"]
    assert faint == [("grey on white", "2.85, least 4.5")]


def test_no_widgets_overlap(found: list[tuple[str, Fault]]) -> None:
    """No text, button, box or image stands on another."""
    assert of_kind(found, "overlap") == []


def test_no_text_is_cut(found: list[tuple[str, Fault]]) -> None:
    """Every word is there from its first letter to its last."""
    assert of_kind(found, "cut") == []


def test_contrast_is_at_least_4_5(found: list[tuple[str, Fault]]) -> None:
    """WCAG 2, level AA: 4.5, or 3 for large letters."""
    assert of_kind(found, "contrast") == []


def test_the_page_is_as_the_system_until_the_browser_has_chosen(
    browser: Any, start_server: Callable[..., Server], tmp_path: Path
) -> None:
    """Light in a light system; dark there once it was chosen, as after a reload."""
    server = start_server(coarse_project(tmp_path))
    context = browser.new_context(color_scheme="light")
    page = context.new_page()
    open_page(page, server.url)
    scheme = "document.documentElement.dataset.mantineColorScheme"
    wait_until(lambda: page.evaluate(scheme) == "light", 30, "the system's")
    page.evaluate(f"localStorage.setItem('viser-user:{STORED}', '{DARK}')")
    page.reload()
    tab(page, "Shape").wait_for()
    wait_until(lambda: page.evaluate(scheme) == "dark", 30, "what was chosen")
    # It stays so, also once all of the page has come.
    page.wait_for_timeout(3_000)
    assert page.evaluate(scheme) == "dark"
    context.close()


def test_axe_finds_nothing_serious(found: list[tuple[str, Fault]]) -> None:
    """Names of all controls and images, roles and what they hold: WCAG 2.2 as axe-core checks."""
    if axe_script() is None:
        pytest.skip("npm could not bring axe-core")
    assert of_kind(found, "axe") == []


MOUSE_ONLY = """
() => [...document.querySelectorAll('body *')].filter(node => {
  const style = getComputedStyle(node), box = node.getBoundingClientRect();
  const hand = style.cursor === 'pointer' || style.cursor === 'ew-resize';
  if (!hand || box.width < 2 || box.height < 2 || style.pointerEvents === 'none') return false;
  const keys = 'a[href], button, input, summary, textarea, [tabindex="0"], label';
  if (node.closest(keys) || node.closest('img, canvas')) return false;
  /* How large a floating window is can be told by the mouse alone: viser's own. */
  if (node.closest('[data-dock-resize]')) return false;
  /* The track of a slider, and what stands beside a box that has the focus. */
  return !node.closest('.mantine-Slider-root, .mantine-Input-wrapper');
}).map(node => (node.innerText || node.className || node.tagName).toString().slice(0, 60))
"""
"""What shows a hand to the mouse, and neither is in the order of Tab nor in what is."""


def test_nothing_is_reached_by_the_mouse_alone(
    pressed_project: Path, page: Any, start_server: Callable[..., Server]
) -> None:
    """Start by its key, a picture by Tab, closed by Escape; a folder and a dock's edge by keys."""
    server = start_server(pressed_project)
    open_page(page, server.url)
    page.locator("[data-title]").first.wait_for()
    # Folders come one after the other, and each is reached once it stands.
    wait_until(lambda: page.evaluate(MOUSE_ONLY) == [], 20, "keys reach all that the mouse does")
    page.keyboard.press("o")
    page.locator('[data-name="Import a body"]').wait_for()
    page.wait_for_timeout(500)
    page.keyboard.press("Tab")
    assert page.evaluate("document.activeElement.dataset.name")
    page.keyboard.press("Escape")
    page.locator('[data-name="Import a body"]').wait_for(state="detached")
    layers = page.locator("[data-title]").filter(has_text="Layers").first
    layers.focus()
    page.keyboard.press("Enter")
    page.locator('[data-title][aria-expanded="false"]').filter(has_text="Layers").wait_for()
    edge = page.locator('[data-dock-region-resize="left"]')
    width = "document.querySelector('[data-dock-region=left]').offsetWidth"
    kept = "Boolean(window.keptDocks && window.keptDocks.back)"
    wait_until(lambda: page.evaluate(kept), 30, "the docks stand")
    before = page.evaluate(width)
    edge.focus()
    page.keyboard.press("ArrowLeft")
    wait_until(lambda: before - page.evaluate(width) > 10, 20, "the dock is narrower")
    page.wait_for_timeout(1500)
    now = page.evaluate(width)
    assert before - now > 10
    tab(page, "Forces").press("Enter")
    page_keeps = f"(localStorage.getItem('{KEPT}') || '').includes('Forces')"
    wait_until(lambda: page.evaluate(page_keeps), 20, "the open tab is kept")
    page.reload()
    tab(page, "Shape").wait_for()
    wait_until(lambda: page.evaluate(kept), 30, "the docks stand again")
    wait_until(lambda: abs(page.evaluate(width) - now) < 3, 20, "as wide as it was left")
    forces = tab(page, "Forces")
    wait_until(lambda: forces.get_attribute("aria-selected") == "true", 20, "open as it was left")
    page.wait_for_timeout(500)
    assert abs(page.evaluate(width) - now) < 3
    assert forces.get_attribute("aria-selected") == "true"
