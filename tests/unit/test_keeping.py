"""The work is kept: full and read-only disks, nonsense in files, clocks set back, moved folders."""

from __future__ import annotations

import shutil
import time
from concurrent.futures import Future
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.surface.primitives import rounded_box
from ui.desk.saving import QUIET_S, RETRY_S, Saving
from ui.desk.session import Session
from workbench.core.base.errors import StoreError, WorkbenchError
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.project.project import Project
from workbench.system.whole_files import write_atomically


class Desk:
    """What the designer is told, and a clock that a test moves."""

    def __init__(self, session: Session) -> None:
        self.now = 100.0
        self.told: list[str] = []
        self.mark = SimpleNamespace(content="", visible=False)
        reports: Any = SimpleNamespace(
            report=lambda error: self.told.append(error.message),
            log=self.told.append,
            notify=lambda *words, **more: None,
        )
        self.saving = Saving(session, reports, self.mark, lambda: self.now)

    def pass_time(self, seconds: float) -> None:
        """Let the writer end what it does, as the pump does."""
        self.now += seconds
        self.saving.turn()
        running: Future[None] | None = self.saving._running  # pyright: ignore[reportPrivateUsage]
        if running is not None:
            running.exception(timeout=10)
        self.saving.turn()


@pytest.fixture
def session(tmp_path: Path) -> Session:
    """A session whose design is saved once."""
    session = Session(Project(tmp_path / "project"))
    session.autosave()
    return session


def test_a_disk_that_refuses_is_told_once_and_tried_until_it_takes(session: Session) -> None:
    """A file in the folder's place: marked, one message, then saved again with the newest edit."""
    desk, folder = Desk(session), session.project.folder / "designs"
    shutil.move(folder, folder.with_name("aside"))
    folder.write_text("in the way")
    session.change("design.shape.cylinder_mm", 20.0)
    desk.saving.edited()
    desk.pass_time(QUIET_S)
    for _ in range(3):
        desk.pass_time(RETRY_S)
    assert desk.mark.visible
    assert "Not saved" in desk.mark.content
    assert len(desk.told) == 1
    session.change("design.shape.cylinder_mm", 21.0)
    folder.unlink()
    shutil.move(folder.with_name("aside"), folder)
    desk.pass_time(RETRY_S)
    assert not desk.mark.visible
    assert desk.told[-1] == "the design is saved again"
    again = Session(Project(session.project.folder))
    again.open(None)
    assert again.design.shape["cylinder_mm"] == 21.0


def test_a_full_disk_keeps_the_last_good_file(session: Session) -> None:
    """With 64 bytes per file at most the old autosave stays, and no half-written file is left."""
    import resource
    import signal

    path = session.project.design_path("autosave")
    before = path.read_bytes()
    session.change("design.shape.cylinder_mm", 20.0)
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    ignored = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (64, hard))
    try:
        with pytest.raises(StoreError, match="cannot write"):
            session.autosave()
        with pytest.raises(StoreError):
            session.store.save("s", "k", np.zeros((40, 40)) + 1.0, seconds=0.0, version=1)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
        signal.signal(signal.SIGXFSZ, ignored)
    assert path.read_bytes() == before
    assert [p.name for p in session.project.folder.rglob(".part-*")] == []
    assert not session.store.has("s", "k")
    session.autosave()
    assert path.read_bytes() != before


def test_nonsense_is_kept_aside_and_never_written_over(session: Session) -> None:
    """Two autosaves edited into nonsense are both kept, under names of their own."""
    path = session.project.design_path("autosave")
    for number, text in enumerate(("]]] not TOML", "\udcff binary")):
        path.write_bytes(text.encode("utf-8", "surrogateescape"))
        again = Session(Project(session.project.folder))
        again.open(None)
        name = f"autosave-broken{f' {number + 1}' if number else ''}.toml"
        assert name in again.notice
        again.autosave()
        kept = path.with_name(name)
        assert kept.read_bytes() == text.encode("utf-8", "surrogateescape")


def test_a_clock_set_back_loses_no_crash_file(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Three bugs in what the clock calls one second are three files."""
    monkeypatch.setattr(time, "strftime", lambda form: "20260101-020000")
    files = [session.project.write_crash(f"bug {number}") for number in range(3)]
    assert [file.read_text() for file in files] == ["bug 0", "bug 1", "bug 2"]


def test_a_clock_set_back_ends_no_step_of_undo(
    session: Session, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The wall clock plays no part: with it an hour back, edits of one moment still undo as one."""
    start, wall = session.state, time.time()
    for number in range(3):
        monkeypatch.setattr(time, "time", lambda n=number: wall - 3600.0 * n)
        session.change("design.shape.cylinder_mm", 20.0 + number)
    assert session.undo()
    assert session.state == start


def test_a_folder_that_moves_finds_its_work(session: Session, tmp_path: Path) -> None:
    """Copied elsewhere, the original gone: same design and press, same keys, results found."""
    points, faces = rounded_box(2.0, 0.5)
    mesh = IndenterMesh(points_mm=points, faces=faces)
    session.replace_indenter(Indenter(kind=IndenterKind.MESH, mesh=mesh))
    session.autosave()
    key = session.calls()["build"].key
    session.store.save("build", key, mesh, seconds=0.0, version=1)
    old = session.project.folder
    written = [file.read_bytes() for file in old.rglob("*") if file.is_file()]
    assert not any(str(old).encode() in content for content in written)
    new = tmp_path / "usb stick" / "project"
    shutil.copytree(old, new)
    shutil.rmtree(old)
    again = Session(Project(new))
    again.open(None)
    assert not again.notice
    assert again.calls()["build"].key == key
    np.testing.assert_allclose(again.result("build").points_mm, points)


def test_what_a_stranger_left_in_the_store_does_not_stop_the_start(session: Session) -> None:
    """Folders that look like parts without a number of a process go, and results stay."""
    session.store.save("s", "k", np.ones(3), seconds=0.0, version=1)
    for name in (".part-x", ".part-", ".part--1"):
        (session.store.root / "s" / name).mkdir()
    assert session.store.sweep() == 3
    assert session.store.has("s", "k")


def test_a_file_in_the_folders_place_is_told(tmp_path: Path) -> None:
    """The message names the file, and no other exception escapes."""
    (tmp_path / "project").write_text("x")
    with pytest.raises(WorkbenchError, match="cannot write"):
        write_atomically(tmp_path / "project" / "a.toml", b"")
    with pytest.raises(StoreError):
        Session(Project(tmp_path / "project")).autosave()


WRITER = """
import sys
from ui.desk.session import Session
from workbench.project.project import Project
session = Session(Project(sys.argv[1]))
for step in range(10_000):
    session.change("design.shape.cylinder_mm", 20.0 + step % 50 / 10)
    session.autosave()
    print(step, flush=True)
"""


def test_kill_while_writing_leaves_a_whole_design(session: Session) -> None:
    """kill -9 in a loop of autosaves: five times the file reads as one of the states written."""
    import subprocess
    import sys

    folder = session.project.folder
    for count in (1, 2, 3, 5, 8):
        command = [sys.executable, "-c", WRITER, str(folder)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as writer:
            assert writer.stdout is not None
            for _ in range(count):
                assert writer.stdout.readline()
            writer.kill()
        again = Session(Project(folder))
        again.open(None)
        assert not again.notice
        assert 20.0 <= again.design.shape["cylinder_mm"] < 25.0
