"""Help, tour and tutorial name what is there, and the help names all of it.

What they print in bold is looked up among labels, tabs, folders and keys of the running program.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from tests.ui.conftest import Server
from tests.ui.inventory import HEADER, Control, controls, laid_out, names
from ui.page.tour import STEPS
from ui.panels.page import pages
from workbench.proof.benchmarks.tab import Tab

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
BOLD = re.compile(r"\*\*(.+?)\*\*", re.DOTALL)
PARAGRAPHS = {"What for.", "Steps.", "Keys.", "Units.", "Your own body.", "Keep it."}
PARAGRAPHS |= {"Motion.", "Solver."}
"""Bold words that begin a paragraph."""
RESULTS = {"Tactile image", "Forces", "Maps", "Log", "Timeline", "Skin", "Pace", "Running"}
TUTORIAL = Path(__file__).parents[2] / "docs" / "tutorial.md"


def bold(text: str) -> set[str]:
    """What a text prints in bold, without the words that begin its paragraphs."""
    return {re.sub(r"\s+", " ", found) for found in BOLD.findall(text)} - PARAGRAPHS


def page_of(control: Control) -> str:
    """The help page that a control belongs to."""
    return "Results" if control.page in RESULTS else control.page


def test_words_in_bold_are_names_and_all_names_are_helped(
    unpressed_project: Path, start_server: Start
) -> None:
    """No text names what is not there; the help of a panel names each control of it."""
    server = start_server(unpressed_project)
    with Tab(server.url) as looking:
        there, found = names(laid_out(looking)), controls(looking)
    texts = {label: folder.help for label, folder in pages().items()}
    texts |= {step.title: step.text for step in STEPS}
    texts["tutorial"] = TUTORIAL.read_text(encoding="utf-8")
    wrong = {name: bold(text) - there for name, text in texts.items()}
    assert {name: words for name, words in wrong.items() if words} == {}
    helped = [c for c in found if page_of(c) in pages() and not c.label.startswith("Help: ")]
    # The sliders of a body are another family's tomorrow; each has its own hint.
    helped = [c for c in helped if not any(name.startswith("Body: ") for name in c.folders)]
    left_out = [f"{c.page}: {c.label}" for c in helped if c.label not in bold(texts[page_of(c)])]
    assert left_out == []
    above = {control.label for control in found if control.page == HEADER}
    assert above <= set().union(*(bold(text) for text in texts.values()))
