"""On no page of a small laptop do widgets overlap, is text cut or too faint to read."""

from __future__ import annotations

import shutil
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.page_faults import Fault, faults, places, unfold
from tests.ui.warm_start import WarmStart
from tests.ui.widgets import DRAW_WHEN_LOOKED_AT, coarse_project, open_page, tab, wait_until
from ui.page.theme import DARK, STORED

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
        rows = []
        for name in places(page):
            unfold(page)
            rows += [(name, fault) for fault in faults(page)]
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
    page.wait_for_timeout(3_000)
    assert page.evaluate(scheme) == "dark"
    context.close()
