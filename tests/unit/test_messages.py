"""What widgets show after a refusal: the design's values, and messages in words of the page."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from ui.panels.fields import Fields
from workbench.core.errors import DesignError


class Widget:
    """A widget of a page without a page."""

    def __init__(self, label: str, value: Any) -> None:
        self.label, self.value = label, value
        self.content, self.visible = "", False
        self.handler: Any = None

    def on_update(self, handler: Any) -> None:
        self.handler = handler

    def entered(self, value: Any) -> None:
        """A person enters a value."""
        self.value = value
        self.handler(SimpleNamespace(client=1))


class Page:
    """The calls of a page that sliders use."""

    def add_slider(
        self, label: str, low: float, high: float, step: float, value: float, *, hint: Any
    ) -> Widget:
        return Widget(label, value)

    def add_markdown(self, text: str, *, visible: bool) -> Widget:
        return Widget("", None)


class Bench:
    """Three fields of a design that takes nothing above 4."""

    def __init__(self) -> None:
        self.state = {
            "design.layers.elastomer_mm": 2.0,
            "design.layers.support_mm": 1.0,
            "design.shape.width_mm": 3.0,
        }
        server = SimpleNamespace(gui=Page())
        self.fields = Fields(server, self.state.__getitem__, self.edit)
        span = (0.5, 6.0, 0.1)
        self.wall, self.support, self.width = (
            self.fields.slider(label, path, span=span)
            for label, path in zip(("Wall", "Support", "Width"), self.state, strict=True)
        )

    def edit(self, path: str, value: float) -> None:
        if value > 4.0:
            self.fields.refuse(path)
            self.fields.complain(DesignError("too thick", at="layers.elastomer_mm"))
        else:
            self.state[path] = value
            self.fields.settle(path)


@pytest.fixture
def bench() -> Bench:
    return Bench()


def test_refused_values_go_when_another_edit_succeeds(bench: Bench) -> None:
    """Wall 6 and support 5 are refused; width 2 is taken: the boxes say 2, 1 and 2."""
    bench.wall.entered(6.0)
    bench.support.entered(5.0)
    assert (bench.wall.value, bench.support.value) == (6.0, 5.0)
    bench.width.entered(2.0)
    assert (bench.wall.value, bench.support.value, bench.width.value) == (2.0, 1.0, 2.0)
    complaint = bench.fields._fields["design.layers.elastomer_mm"].complaint
    assert not complaint.visible


def test_an_entry_at_the_end_of_a_slider_says_so(bench: Bench) -> None:
    """0.5 is the lower end: the ends stand under the slider; 1 takes them away."""
    complaint = bench.fields._fields["design.shape.width_mm"].complaint
    bench.width.entered(0.5)
    assert complaint.visible
    assert "from 0.5 to 6" in complaint.content
    bench.width.entered(1.0)
    assert not complaint.visible


def test_messages_use_labels_of_the_part_they_are_about(bench: Bench) -> None:
    """Bare names beside the field are its neighbours' labels; the same word elsewhere is not."""
    text = "lower support_mm or layers.elastomer_mm; width_mm stays"
    words = bench.fields.in_words(text, "layers.elastomer_mm")
    assert words == "lower “Support” or “Wall”; width_mm stays"
