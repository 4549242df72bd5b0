"""A typed name is the one that is saved, in whatever order the messages of a page are handled."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ui.desk.session import Session
from ui.panels.shape.design_files import SAVE, DesignFiles
from workbench.project.project import Project
from workbench.project.saved_designs import open_design, saved_names


@pytest.fixture
def files(tmp_path: Path) -> DesignFiles:
    """The widgets of a design `old`, saved once, without a page."""
    session = Session(Project(tmp_path))
    session.change("design.name", "old")
    ignored = lambda *words, **named: None  # noqa: E731
    desk: Any = SimpleNamespace(
        session=session,
        fields=SimpleNamespace(read_typed=ignored),
        edit=session.change,
        log=ignored,
        reports=SimpleNamespace(notify=ignored),
    )
    made = DesignFiles(desk)
    made.name = SimpleNamespace(value="old")
    made.kept = SimpleNamespace(options=(), value="")
    made._draw = ignored
    save(made)
    return made


def save(files: DesignFiles) -> None:
    """Ctrl+S."""
    files._keep(SAVE, SimpleNamespace(client=object()))


def test_save_takes_the_name_whose_own_message_waits(files: DesignFiles) -> None:
    """Typed, then saved, then handled: a file of the new name, and the old one as it was."""
    before = open_design(files.project, "old")
    files.desk.session.change("design.layers.elastomer_mm", 2.6)
    files.name.value = "new"
    # An edit that is handled in between shows the design as it stands.
    files.refresh()
    save(files)
    assert saved_names(files.project) == ("new", "old")
    assert open_design(files.project, "old") == before
    assert open_design(files.project, "new").design.layers.elastomer_mm == 2.6
    assert files.name.value == "new"


def test_a_name_from_elsewhere_is_shown(files: DesignFiles) -> None:
    """Undo, a preset, another tab: the box follows the design."""
    session = files.desk.session
    session.replace_design(dataclasses.replace(session.design, name="another"))
    files.refresh()
    assert files.name.value == "another"


def test_an_empty_name_is_none(files: DesignFiles) -> None:
    """The design keeps the name it has."""
    files.name.value = " "
    save(files)
    assert saved_names(files.project) == ("old",)
