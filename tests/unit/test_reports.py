"""What threads tell: one at a time, bugs once, and one step of the pump never stops another."""

from __future__ import annotations

import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from geometry.surface.surface_place import SkinPlace
from ui.desk.aiming import Aiming
from ui.desk.followers import Followers
from ui.desk.reports import Reports
from ui.desk.thumbnails import ThumbnailQueue
from ui.scene.ghost import Ghost, GhostView
from workbench.core.base.errors import StoreError
from workbench.project.project import Project


@pytest.fixture
def project(tmp_path: Path) -> Project:
    return Project(tmp_path)


@pytest.fixture
def reports(project: Project) -> Reports:
    server: Any = SimpleNamespace(get_clients=dict)
    session: Any = SimpleNamespace(project=project)
    fields: Any = SimpleNamespace(lock=threading.RLock())
    return Reports(server, session, fields)


def ask_meanwhile(reports: Reports, act: Any) -> bool:
    """Whether an act of another thread waits while this one has the lock."""
    thread = threading.Thread(target=act)
    with reports.lock:
        thread.start()
        thread.join(0.2)
        waited = thread.is_alive()
    thread.join(5)
    return waited


def fail() -> None:
    raise RuntimeError("broken")


def crash_files(project: Project) -> int:
    return len(list((project.folder / "crash").iterdir()))


def test_a_line_of_another_thread_waits_for_the_widgets(reports: Reports) -> None:
    """Logging takes the desk's lock; a line for the event loop waits for the pump instead."""
    assert ask_meanwhile(reports, lambda: reports.log("a thumbnail"))
    assert not ask_meanwhile(reports, lambda: reports.log_soon("another tab edits now"))
    assert len(reports.lines) == 1
    reports.turn()
    assert reports.lines[-1].endswith("another tab edits now")


def test_the_same_bug_is_written_once_and_counted(
    reports: Reports, project: Project, capsys: pytest.CaptureFixture[str]
) -> None:
    """Thirty times the same: one file, one traceback, and a line at the tenth."""
    for _ in range(30):
        reports.guarded(lambda event: fail())(None)
    assert crash_files(project) == 1
    assert capsys.readouterr().err.count("RuntimeError: broken") == 1
    assert [line[9:23] for line in reports.lines] == ["internal error"] * 2
    assert "10 times by now" in reports.lines[-1]


def test_a_step_that_fails_stops_no_other(reports: Reports) -> None:
    """The design is saved and results are brought up to date while a handle breaks each turn."""
    turned: list[str] = []

    def step(name: str) -> Any:
        return SimpleNamespace(turn=lambda: turned.append(name))

    desk: Any = SimpleNamespace(
        guarded=reports.guarded,
        reports=reports,
        fields=SimpleNamespace(read_typed=fail),
        gizmos=[SimpleNamespace(turn=fail), step("gizmo")],
        background=step("background"),
        scene=SimpleNamespace(pressed=step("pressed")),
        auto_update=step("auto_update"),
        saving=step("saving"),
        on_turn=[lambda: turned.append("tenancy")],
    )
    desk.desk = desk
    Followers._idle(desk)  # pyright: ignore[reportPrivateUsage]
    assert turned == ["saving", "gizmo", "background", "pressed", "auto_update", "tenancy"]


def test_a_thumbnail_is_told_under_the_lock(reports: Reports, project: Project) -> None:
    """The list of variants is redrawn by nobody while a widget's handler runs."""
    thumbnails, drawn = ThumbnailQueue(project, SimpleNamespace(), reports), threading.Event()  # pyright: ignore[reportArgumentType]
    thumbnails.on_drawn = drawn.set
    with reports.lock:
        thumbnails.draw("missing")
        assert not drawn.wait(0.3)
    assert drawn.wait(5)


@pytest.mark.parametrize(("error", "told"), [(StoreError("damaged"), 0), (ValueError("bug"), 1)])
def test_what_breaks_while_ghosts_are_drawn_is_told(error: Exception, told: int) -> None:
    """A damaged result is as good as none; anything else reaches the designer."""

    def load(*words: Any) -> None:
        raise error

    ended, bugs, missing = threading.Event(), [], []

    def on_error(bug: Exception) -> None:
        bugs.append(bug)
        ended.set()

    def then(words: str) -> None:
        missing.append(words)
        ended.set()

    server: Any = SimpleNamespace(atomic=threading.Lock)
    view, side = GhostView(server, None, on_error=on_error), SimpleNamespace(load=load)  # pyright: ignore[reportArgumentType]
    ghost = Ghost(label="B", side=side, colour=(1, 2, 3), place=1, pressed=False)  # pyright: ignore[reportArgumentType]
    view.show([ghost], own="A", bounds_mm=(np.zeros(3), np.ones(3)), then=then)
    assert ended.wait(5)
    assert (len(bugs), len(missing)) == (told, 1 - told)


OFF = SkinPlace(np.ones(3), 9.0, 0, np.array([0.0, 0.0, 1.0]))


@pytest.mark.parametrize("live", [False, True])
def test_all_who_follow_the_target_hear_that_it_moved(live: bool) -> None:
    """Saving, Auto update and the preview; the live press where it is on."""
    told: list[str] = []

    def tells(name: str) -> Any:
        return lambda *words: told.append(name)

    desk: Any = SimpleNamespace(
        saving=SimpleNamespace(edited=tells("saving")),
        auto_update=SimpleNamespace(edited=tells("auto_update")),
        fields=SimpleNamespace(refresh=tells("fields")),
        log=tells("log"),
        live=live,
        live_press=SimpleNamespace(follow=tells("live")),
        image_preview=SimpleNamespace(follow=tells("image_preview")),
        scene=SimpleNamespace(body=SimpleNamespace(place_near=lambda point: OFF)),
        session=SimpleNamespace(
            case=SimpleNamespace(press=SimpleNamespace(target_mm=(0.0, 0.0, 0.0))),
            design=SimpleNamespace(family="finger"),
            amend=tells("amend"),
        ),
    )
    desk.scene.body.solid, desk.desk = None, desk
    desk.amended = lambda words: Followers._follow_amended(desk, words)  # pyright: ignore[reportPrivateUsage]
    Aiming(desk).keep_aim()
    follow = {"live"} if live else set()
    assert (
        set(told) == {"amend", "saving", "auto_update", "fields", "log", "image_preview"} | follow
    )
