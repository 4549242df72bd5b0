"""Another family in the browser: its own sliders, its own body in the view, its own meshes."""

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
    labels,
    open_page,
    tab,
    view,
    wait_until,
)

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
MOVED = 0.05
"""Share of the view that another body or another eye changes at least; a slider's box changes
nothing of it."""
SWITCH_S = 60.0


def switch(page: Any, name: str) -> None:
    """Start from another preset and wait for its body."""
    choose(page, "Start from", name)
    page.get_by_text(f"{name} · {name}").wait_for()
    wait_until(lambda: page.get_by_text("Shape ✓").count(), SWITCH_S, f"the {name} is built")


def test_trunk_and_pad_bring_their_sliders_and_bodies(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """Finger to trunk to pad: sliders of the one go, those of the other come, the view changes."""
    server = start_server(unpressed_project)
    open_page(page, server.url)
    wait_until(lambda: page.get_by_text("Shape ✓").count(), SWITCH_S, "the finger is built")
    assert "Outer radius mm" in labels(page)
    views = [view(page)]
    for name, own in (("trunk", "Saddle height mm"), ("pad", "Standoff mm")):
        switch(page, name)
        assert own in labels(page)
        assert "Outer radius mm" not in labels(page)
        wait_until(lambda: changed_share(views[-1], view(page)) > MOVED, 20, f"{name} is drawn")
        views.append(view(page))
    assert "Saddle height mm" not in labels(page)


def test_mesh_quality_and_worst_cell(
    unpressed_project: Path, page: Any, start_server: Start
) -> None:
    """Check mesh shows numbers of three meshes; the worst cell moves the eye; tetrahedra cancel."""
    server = start_server(unpressed_project)
    open_page(page, server.url)
    tab(page, "Mesh").click()
    button(page, "Check mesh").click()
    button(page, "Show worst cell").wait_for(timeout=90_000)
    page.get_by_text("scaled Jacobian [1]: worst").first.wait_for()
    before = view(page)
    button(page, "Show worst cell").click()
    wait_until(lambda: changed_share(before, view(page)) > MOVED, 20, "the eye moved")
    choose(page, "Mesh shown", "inner skin")
    page.get_by_text("smallest angle [deg]: worst").wait_for()
    button(page, "Tetrahedra").click()
    button(page, "Cancel").wait_for(timeout=30_000)
    button(page, "Cancel").click()
    button(page, "Cancel").wait_for(state="hidden", timeout=15_000)
