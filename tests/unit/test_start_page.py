"""The start page's pictures: what was kept last, what ships, and ways that lead elsewhere."""

from __future__ import annotations

import dataclasses
import os
import re
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ui.page.gallery import Card, cards_html
from ui.panels.page import pages
from ui.panels.shape.design_files import MARK, DesignFiles
from ui.panels.shape.start_page import MOST_RECENT, OWN, VARIANT, WAYS, StartPage
from ui.patches.leading import empty_state
from workbench.core.press.press_case import PressCase
from workbench.edit.forms import choices, load_design
from workbench.project.project import Project
from workbench.project.saved_designs import save_named
from workbench.project.state import State
from workbench.variants.variants import save_variant, variant_path


class Buttons(HTMLParser):
    """Data of all buttons of a piece of HTML."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.found: list[dict[str, str | None]] = []
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Keep what a button carries."""
        if tag == "button":
            self.found.append(dict(attrs))


@pytest.fixture
def start(tmp_path: Path) -> StartPage:
    """The page of a project that has nothing yet, on a desk that keeps what it is given."""
    project = Project(tmp_path)
    given: list[State] = []
    command = SimpleNamespace(on_trigger=lambda act: None)
    gui = SimpleNamespace(add_command=lambda *words, **look: command)
    session: Any = SimpleNamespace(
        project=project, given=given, replace_state=given.append, design=load_design("finger")
    )
    desk: Any = SimpleNamespace(
        session=session,
        server=SimpleNamespace(gui=gui),
        guarded=lambda act: act,
        replaced=lambda: None,
    )
    return StartPage(desk, DesignFiles(desk))


def test_a_new_project_has_all_that_ships_and_the_ways(start: StartPage) -> None:
    """Nothing of one's own; each way leads to a page that there is, and to a folder there."""
    cards = start.cards()
    assert [card.name for card in cards] == [*choices(), *(way.name for way in WAYS)]
    assert {way.goto for way in WAYS} <= set(pages())
    source = Path("ui/panels/shape/page.py").read_text(encoding="utf-8")
    assert all(f'add_folder("{way.fold}"' in source for way in WAYS if way.fold)


def test_what_was_kept_last_comes_first(start: StartPage) -> None:
    """Designs and variants by the time of their files; no more than a few; each opens itself."""
    project = start.project
    for number in range(MOST_RECENT + 1):
        design = dataclasses.replace(load_design("pad"), name=f"pad {number}")
        path = save_named(project, State(design=design, case=PressCase()))
        os.utime(path, (number, number))
    save_variant(project, "the best", State(design=load_design("thumb"), case=PressCase()))
    os.utime(variant_path(project, "the best"), (2.5, 2.5))
    own = [card.name for card in start.cards() if card.group == OWN]
    assert own == [f"pad 4{MARK}", f"pad 3{MARK}", f"the best{VARIANT}", f"pad 2{MARK}"]
    for name, family in ((own[0], "pad"), (own[2], "thumb")):
        start.choose(name)
        assert vars(start.desk.session)["given"][-1].design.family == family


def test_cards_are_buttons_that_say_where_they_lead() -> None:
    """Names typed by somebody are escaped; a card that leads carries tab and folder."""
    cards = (Card(name='a "b" <i>'), Card(name="go", goto="Shape", fold="Own", icon="body"))
    first, second = Buttons(cards_html(cards)).found
    assert first["data-name"] == 'a "b" <i>'
    assert "data-goto" not in first
    assert (second["data-goto"], second["data-fold"]) == ("Shape", "Own")


def test_an_empty_place_has_one_button_that_does_something() -> None:
    """A sentence, escaped, and one button with what it does."""
    text = empty_state("Nothing < yet", "Run press (R)", key="r")
    assert [one["data-key"] for one in Buttons(text).found] == ["r"]
    assert "Nothing &lt; yet" in re.sub(r"<button.*", "", text)
