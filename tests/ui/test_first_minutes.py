"""The first minutes: a tour shown once, help on every panel, every command in the keyboard map."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.widgets import button, coarse_project, open_page, set_number, tab, wait_until
from ui.page.keys import Command, in_words
from ui.page.tour import STEPS
from ui.panels.page import pages
from workbench.proof.benchmarks.tab import Tab

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]


def clashes(commands: list[Command]) -> list[str]:
    """Keys and names that more than one command has."""
    keys = Counter(command.keys for command in commands if command.keys)
    labels = Counter(command.label for command in commands)
    return [name for name, count in (keys + labels).items() if count > 1]


def test_the_tour_is_shown_once_and_again_on_request(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """All steps, each with its tab open; none after a reload; the palette opens it again."""
    server = start_server(coarse_project(tmp_path), tour=True)
    open_page(page, server.url)
    for number, step in enumerate(STEPS):
        page.get_by_text(step.title).first.wait_for()
        spoken_of = tab(page, step.tabs[0])
        wait_until(lambda t=spoken_of: t.get_attribute("aria-selected") == "true", 10, "it is open")
        dock, words = spoken_of.bounding_box(), page.get_by_text(step.title).first.bounding_box()
        right = words["x"] > dock["x"] + dock["width"]
        assert right or words["x"] + words["width"] < dock["x"]
        button(page, "Next" if number < len(STEPS) - 1 else "Close").click()
    page.get_by_text(STEPS[-1][0]).first.wait_for(state="hidden")
    page.reload()
    tab(page, "Shape").wait_for()
    page.wait_for_timeout(4_000)
    assert not page.get_by_text(STEPS[0][0]).count()
    page.keyboard.press("Control+k")
    page.get_by_placeholder("Search commands").fill("Tour")
    page.keyboard.press("Enter")
    page.get_by_text(STEPS[0][0]).first.wait_for()
    page.screenshot(path=str(tmp_path / "tour.png"))
    # As long as the palette is on its way out, the key belongs to it.
    page.get_by_placeholder("Search commands").wait_for(state="hidden")
    page.keyboard.press("Escape")
    page.get_by_text(STEPS[0][0]).first.wait_for(state="hidden")


def test_the_tour_goes_on_as_its_steps_are_done(
    pressed_project: Path, page: Any, start_server: Start
) -> None:
    """A slider that was let go leads on, not while it is dragged; so does a large image."""
    server = start_server(pressed_project, tour=True)
    open_page(page, server.url)
    page.get_by_text(STEPS[0].title).first.wait_for()
    for radius_mm in (14.8, 14.6, 14.4):
        set_number(page, "Outer radius mm", radius_mm)
        page.wait_for_timeout(500)
        assert page.get_by_text(STEPS[0].title).count(), "not while one edits"
    page.get_by_text(STEPS[1].title).first.wait_for()
    button(page, "Next").click()
    page.get_by_text(STEPS[2].title).first.wait_for()
    page.keyboard.press("i")
    page.get_by_text(STEPS[3].title).first.wait_for()


def test_help_opens_on_every_panel_also_in_a_tab_that_follows(
    unpressed_project: Path, start_server: Start
) -> None:
    """Each button opens its own page; the keyboard map names every command once, with its key."""
    server = start_server(unpressed_project)
    with Tab(server.url) as editor, Tab(server.url) as follower:
        editor.uuid("Help: Shape")
        for panel in pages():
            for who in (editor, follower):
                who.click(f"Help: {panel}")
                words = pages()[panel].help.splitlines()[0]
                who.wait(lambda w=who, t=words: w.has_seen(t[:60]), 10, f"help on {panel}")
        shared = [
            Command(label=props["label"], keys=in_words(props["hotkey"], props["modifier"]))
            for props in editor.commands.values()
            if not props["label"].startswith("Close:")
        ]
        assert clashes(shared) == []
        labels = {command.label for command in shared}
        wanted = {"Run press", "Render image", "Cancel what runs", "Undo", "Redo", "Fit view"}
        assert labels >= wanted | {"Tour", "Keyboard map"} | {f"Help on {p}" for p in pages()}
        editor.trigger("Keyboard map")
        for command in shared:
            row = f"| {command.label} | {command.keys} |"
            editor.wait(lambda r=row: editor.has_seen(r), 10, f"the map has {row}")
