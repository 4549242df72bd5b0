"""What does not fit is said while the slider moves, and nothing shows another body's results."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from workbench.proof.benchmarks.tab import Tab

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
RADIUS, DEPTH, FIT = "Outer radius mm", "Depth mm", "Fit LEDs and camera to the body"


@pytest.fixture
def server(unpressed_project: Path, start_server: Start) -> Server:
    """A coarse finger."""
    return start_server(unpressed_project)


def texts(tab: Tab) -> list[str]:
    """Markdown that is on show."""
    return [
        str(widget.get("_markdown"))
        for widget in tab.widgets.values()
        if widget.get("visible", True) and widget.get("_markdown")
    ]


def said(tab: Tab, words: str) -> bool:
    return any(words in text for text in texts(tab))


def shown(tab: Tab, label: str) -> bool:
    uuid = tab.find(label)
    return bool(uuid) and tab.widgets[uuid].get("visible", True)


def test_a_ring_that_a_new_radius_no_longer_holds(server: Server) -> None:
    """Radius 15 to 10: said in seconds, before anything is meshed; one click brings it inside."""
    with Tab(server.url) as tab:
        tab.uuid(RADIUS)
        tab.wait(lambda: said(tab, "Shape"), 20, "the strip is there")
        assert not said(tab, "Does not fit")
        tab.set(RADIUS, 10.0)
        # The first answer waits for a worker that is just starting.
        tab.wait(lambda: said(tab, "Does not fit"), 90, "it is said")
        assert said(tab, "LED 1 of 9")
        tab.wait(lambda: shown(tab, FIT), 5, "the remedy is offered")
        tab.click(FIT)
        tab.wait(lambda: not said(tab, "LED 1 of 9"), 30, "they are inside")
        assert not shown(tab, FIT)
        assert tab.value("Ring radius mm") < 7.0
        tab.trigger("Undo")
        tab.wait(lambda: shown(tab, FIT), 20, "undone as one step")


def test_a_depth_beyond_the_wall_is_said_without_a_press(server: Server) -> None:
    """5 mm into a wall of 2: with the largest that fits."""
    with Tab(server.url) as tab:
        tab.uuid(DEPTH)
        tab.set(DEPTH, 5.0)
        tab.wait(lambda: said(tab, "reaches the support"), 90, "it is said")
        tab.set(DEPTH, 1.0)
        tab.wait(lambda: not said(tab, "Does not fit"), 20, "it goes")


def test_another_family_takes_the_old_marks_away_at_once(server: Server) -> None:
    """From the moment the name is the trunk's, Shape is never ✓ until its body is there."""
    with Tab(server.url) as tab:
        tab.uuid(RADIUS)
        tab.wait(lambda: said(tab, "Shape&nbsp;✓"), 30, "the finger is built")
        tab.seen.clear()
        tab.set("Start from", "trunk")
        tab.wait(lambda: said(tab, "trunk"), 20, "the design is the trunk")
        tab.wait(lambda: said(tab, "Shape&nbsp;✓"), 60, "the trunk is built")
        strips = [text for text in history(tab) if text.startswith("<small>Shape")]
        named = next(k for k, text in enumerate(history(tab)) if "· trunk" in text)
        before = [text for text in history(tab)[named:] if text.startswith("<small>Shape")]
        assert any("Shape&nbsp;▶" in text or "Shape ▶" in text for text in strips)
        assert "✓" not in before[0].split("Mesh")[0]


def history(tab: Tab) -> list[str]:
    """Every Markdown and HTML in the order in which it came."""
    found: list[Any] = []
    for _, message in list(tab.seen):
        updates = message.get("updates", {}) if isinstance(message, dict) else {}
        text = updates.get("_markdown") or updates.get("content")
        if text:
            found.append(str(text))
    return found


def test_empty_places_say_what_fills_them() -> None:
    """Lines of text in the image: it is not one grey."""
    from ui.page.imaging import placeholder
    from ui.panels.results.image import CHANGE_COMES, IMAGE_COMES

    for lines in (IMAGE_COMES, CHANGE_COMES):
        assert len({tuple(pixel) for row in placeholder(*lines) for pixel in row}) > 5
