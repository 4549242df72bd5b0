"""A file of 40 MB holds no other tab up: what takes its time is done without the desk's lock.

Counted, not timed: how many bytes are digested, and how many files read, while other tabs wait.
"""

from __future__ import annotations

import hashlib
import threading
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import workbench.edit.indenter_edit
import workbench.live.object_file
from ui.desk.reports import Reports
from ui.panels.shape.intake import IntakeFolder
from ui.panels.simulate.objects import ObjectFolder
from workbench.core.base.errors import DesignError
from workbench.live.object_file import ObjectFile
from workbench.system.uploads import MOST_BYTES


class FakeDesk:
    """A desk that remembers what its workers are asked for."""

    def __init__(self) -> None:
        self.asked: list[Any] = []
        fields: Any = SimpleNamespace(
            lock=threading.RLock(), settle=lambda path: None, in_words=lambda text, at: text
        )
        fields.complain = lambda error: error.at
        server: Any = SimpleNamespace(get_clients=dict)
        session: Any = SimpleNamespace(state=None, design=SimpleNamespace(family="finger"))
        session.design.body = None
        self.session = session
        self.reports = Reports(server, session, fields)
        self.reports.banner = SimpleNamespace(content="", visible=False)
        self.jobs = SimpleNamespace(ask=lambda job, call, state, then: self.asked.append(call))

    def trial(self, job: str, design: Any, wanted: str, then: Any) -> None:
        self.asked.append(design)


@pytest.fixture
def desk() -> FakeDesk:
    return FakeDesk()


def sent(name: str, size: int) -> Any:
    """An upload button that has received a file."""
    return SimpleNamespace(value=SimpleNamespace(name=name, content=bytes(size)))


def objects(desk: FakeDesk, button: Any) -> Any:
    """The callback of the button that loads an object."""
    folder: Any = SimpleNamespace(desk=desk, file=button, _read=None)
    return desk.reports.received(
        lambda: ObjectFolder._sent(folder),  # pyright: ignore[reportPrivateUsage]
        lambda call: ObjectFolder._load_file(folder, call),  # pyright: ignore[reportPrivateUsage]
    )


def bodies(desk: FakeDesk, button: Any) -> Any:
    """The callback of the button that loads a body."""
    folder: Any = IntakeFolder.__new__(IntakeFolder)
    folder.desk, folder.outer, folder.trial = desk, button, None
    folder.unit = SimpleNamespace(value="mm")
    folder.said, folder.mend = SimpleNamespace(content=""), SimpleNamespace(visible=False)
    return desk.reports.received(folder._sent_outer, folder._load_outer)


@pytest.fixture
def digested(desk: FakeDesk, monkeypatch: pytest.MonkeyPatch) -> dict[bool, int]:
    """Bytes that were digested, by whether other tabs waited meanwhile."""
    found, real = {True: 0, False: 0}, hashlib.sha256

    def counted(data: bytes = b"") -> Any:
        held: Any = desk.reports.lock
        found[held._is_owned()] += len(data)
        return real(data)

    monkeypatch.setattr("workbench.core.design.imported.hashlib.sha256", counted)
    return found


@pytest.mark.parametrize(("make", "name"), [(bodies, "body.stl"), (objects, "object.step")])
def test_the_digest_of_a_file_is_made_without_the_lock(
    desk: FakeDesk, digested: dict[bool, int], make: Any, name: str
) -> None:
    """All of 40 MB, and none while other tabs wait; the worker gets the file."""
    make(desk, sent(name, MOST_BYTES))(None)
    assert digested == {True: 0, False: MOST_BYTES}
    (design,) = desk.asked
    assert isinstance(design.body.outer.data, np.ndarray)


def test_an_stl_object_is_read_by_the_worker_alone(
    desk: FakeDesk, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Its triangles take seconds: the server hands the bytes on as they came, uncopied."""
    read: list[str] = []
    monkeypatch.setattr(
        workbench.live.object_file, "uploaded", lambda name, content: read.append(name)
    )
    monkeypatch.setattr(workbench.edit.indenter_edit, "choose_indenter", read.append)
    button = sent("object.stl", MOST_BYTES)
    objects(desk, button)(None)
    (call,) = desk.asked
    assert isinstance(call, ObjectFile)
    assert call.content is button.value.content
    assert not read


@pytest.mark.parametrize(("make", "name"), [(bodies, "body.stl"), (objects, "object.stl")])
def test_a_file_that_is_too_large_is_told_and_goes_nowhere(
    desk: FakeDesk, make: Any, name: str
) -> None:
    """Beyond 40 MB: a message with both sizes, and no worker hears of it."""
    make(desk, sent(name, MOST_BYTES + 1))(None)
    assert desk.asked == []
    assert "the browser takes 40 MB" in desk.reports.lines[-1]


def test_what_is_taken_is_taken_under_the_lock(desk: FakeDesk) -> None:
    """Reading without, taking with; an error of either is told."""
    lock: Any = desk.reports.lock
    held: list[bool] = []

    def read() -> str:
        held.append(lock._is_owned())
        return "file"

    def take(file: str) -> None:
        held.append(lock._is_owned())
        raise DesignError(f"{file} is broken", at="body")

    desk.reports.received(read, take)(None)
    assert held == [False, True]
    assert desk.reports.lines[-1].endswith("file is broken.")
