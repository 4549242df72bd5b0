"""Who writes a project that several servers have open, and what is lost of that: nothing unsaid."""

from __future__ import annotations

import dataclasses
import json
import os
from collections.abc import Callable
from pathlib import Path
from typing import cast

from ui.desk.session import Session
from ui.page.editor import Editor
from ui.tenancy import LOCK, Tenancy
from workbench.project.project import Project
from workbench.system.names import AUTOSAVE


class Door:
    """An editor without tabs."""

    def __init__(self) -> None:
        self.why: list[str] = []
        self.on_open: Callable[[], None] | None = None

    @property
    def is_shut(self) -> bool:
        return self.on_open is not None

    def shut(self, why: str, on_open: Callable[[], None]) -> None:
        self.why.append(why)
        self.on_open = on_open


def opened(folder: Path) -> tuple[Session, Tenancy, Door]:
    """A server on a project, as it stands after its start."""
    session, door = Session(Project(folder)), Door()
    session.open(None)
    tenancy = Tenancy(folder, session, link="http://here:1/")
    tenancy.follow(cast("Editor", door), tenancy.enter())
    return session, tenancy, door


def turn(tenancy: Tenancy) -> None:
    """One look at the lock, whenever the last one was."""
    tenancy._looked = -1e9  # pyright: ignore[reportPrivateUsage]
    tenancy.turn()


def saved_name(session: Session) -> str:
    """Name of the design as it stands in the file."""
    path = session.project.design_path(AUTOSAVE)
    lines = path.read_text().splitlines() if path.exists() else []
    return next((line for line in lines if line.startswith("name")), "")


def test_an_edit_is_written_although_somebody_deleted_the_lock(tmp_path: Path) -> None:
    """Nobody else has the project: the lock is taken again, and the design kept meanwhile."""
    session, tenancy, door = opened(tmp_path)
    (tmp_path / LOCK).unlink()
    session.change("design.name", "kept")
    session.autosave()
    assert "kept" in saved_name(session)
    turn(tenancy)
    assert tenancy.lock.is_own
    assert not door.is_shut


def test_the_second_writes_nothing_and_learns_that_the_first_has_ended(tmp_path: Path) -> None:
    """Until it takes over: then with what the first had made, and nothing of its own to undo."""
    first, one, _ = opened(tmp_path)
    first.change("design.name", "first")
    first.autosave()
    second, two, door = opened(tmp_path)
    assert "another workbench has this project" in door.why[-1]
    second.change("design.name", "second")
    second.autosave()
    assert "first" in saved_name(second)
    first.change("design.name", "later")
    first.autosave()
    turn(two)
    assert len(door.why) == 1
    one.leave()
    turn(two)
    assert "has ended" in door.why[-1]
    assert door.on_open is not None
    door.on_open()
    assert second.design.name == "later"
    assert not second.undo()
    second.change("design.name", "mine")
    second.autosave()
    assert "mine" in saved_name(second)


def test_who_is_taken_over_writes_no_more(tmp_path: Path) -> None:
    """Not even before it has seen that."""
    first, one, door = opened(tmp_path)
    other = dataclasses.asdict(one.lock.own) | {"mark": "other", "pid": os.getppid(), "started": ""}
    (tmp_path / LOCK).write_text(json.dumps(other))
    first.change("design.name", "late")
    first.autosave()
    assert "late" not in saved_name(first)
    turn(one)
    assert door.is_shut
