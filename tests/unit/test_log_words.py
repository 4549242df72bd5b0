"""What stands in the log: the remedy with every message, once, and a refused value as a note."""

from __future__ import annotations

import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from ui.desk.reports import Reports, in_full
from workbench.core.base.errors import DesignError, LaneError
from workbench.project.project import Project
from workbench.variants.variant_files import Shelf


@pytest.fixture
def reports(tmp_path: Path) -> Reports:
    """Of a page with a widget for the wall alone."""
    fields: Any = SimpleNamespace(
        lock=threading.RLock(),
        complain=lambda error: "design.wall" if error.at == "wall" else "",
        in_words=lambda text, at: text,
    )
    session: Any = SimpleNamespace(project=Project(tmp_path))
    server: Any = SimpleNamespace(get_clients=dict)
    reports = Reports(server, session, fields)
    reports.banner = SimpleNamespace(content="", visible=False)
    return reports


def words(reports: Reports) -> list[str]:
    """The lines without their times."""
    return [line.partition(" ")[2] for line in reports.lines]


@pytest.mark.parametrize(
    ("message", "hint", "full"),
    [
        ("the wall is thin", "", "the wall is thin."),
        ("the wall is thin", "take 2 mm", "the wall is thin. Take 2 mm."),
        ("the wall is thin.", "take 2 mm.", "the wall is thin. Take 2 mm."),
        ("the worker ended", "run doctor\nTraceback (most", "the worker ended. Run doctor."),
        ("a bug", "Traceback (most recent call last):\n  File", "a bug."),
    ],
)
def test_a_message_has_its_remedy_once(message: str, hint: str, full: str) -> None:
    """As two sentences; a traceback is for the crash file, what stands before it for people."""
    assert in_full(message, hint) == full


def test_the_remedy_before_a_traceback_is_told(reports: Reports) -> None:
    """A worker that cannot be made ready says what to do; its traceback goes to a file."""
    reports.report(LaneError("the sim process cannot import x", hint="run doctor\nTraceback (y"))
    assert words(reports) == ["the sim process cannot import x. Run doctor."]
    assert "Run doctor" in reports.banner.content
    assert len(list((reports.session.project.folder / "crash").iterdir())) == 1


def test_values_refused_along_a_drag_are_one_note(reports: Reports) -> None:
    """The slider's last good value stays: a note, the newest alone, and no banner."""
    for wall_mm in (0.3, 0.2, 0.1):
        error = DesignError(f"the wall of {wall_mm} mm is thin", hint="take 2 mm", at="wall")
        reports.report(error, edited="design.wall")
    assert words(reports) == ["note: the wall of 0.1 mm is thin. Take 2 mm."]
    assert not reports.banner.visible
    reports.log("press: started")
    reports.report(DesignError("the wall is thin", at="wall"), edited="design.wall")
    assert len(reports.lines) == 3


def test_what_failed_is_no_note(reports: Reports) -> None:
    """The same message of a press that was asked for stands as it is, each time, in the banner."""
    for _ in range(2):
        reports.report(DesignError("the wall is thin", hint="take 2 mm", at="wall"), job="press")
    assert words(reports) == ["the wall is thin. Take 2 mm."] * 2
    assert reports.banner.visible


@pytest.mark.parametrize("name", ["thin wall", "a<b"])
def test_a_refused_variant_is_not_named_twice(tmp_path: Path, name: str) -> None:
    """The list has the name before the reason; the reason has it no more."""
    project = Project(tmp_path)
    (project.folder / "variants").mkdir(parents=True)
    (project.folder / "variants" / f"{name}.toml").write_text("x = 1")
    (entry,) = Shelf(project).entries()
    assert entry.name == name
    assert entry.reason
    assert name not in entry.reason
