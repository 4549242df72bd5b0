"""Several tabs: one edits, the others follow; a reload and a restart in mid-job lose nothing.

Most of it speaks viser's protocol without a browser (`workbench.proof.benchmarks.tab`).
"""

from __future__ import annotations

import contextlib
import re
import signal
import subprocess
import sys
import time
import tomllib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.ui.conftest import Server
from tests.ui.warm_start import WarmStart
from tests.ui.widgets import button, coarse_project, open_page, tab, wait_until
from ui.page.editor import RELOAD_S
from workbench.proof.benchmarks.tab import Tab

pytestmark = [pytest.mark.ui, pytest.mark.slow]

Start = Callable[..., Server]
LENGTH, RADIUS = "Straight length mm", "Outer radius mm"


@pytest.fixture(scope="module")
def server(warm: WarmStart, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """A server that no tab is open on when a test begins."""
    with Server(coarse_project(tmp_path_factory.mktemp("tabs")), warm=warm) as running:
        yield running


@pytest.fixture
def two(server: Server) -> Iterator[tuple[Tab, Tab]]:
    """The editor and a follower; the finger has its first length and radius."""
    with Tab(server.url) as editor:
        editor.uuid(LENGTH)
        editor.wait(lambda: not editor.find("Edit here"), 10, "it edits")
        editor.set(LENGTH, 27.0)
        editor.set(RADIUS, 15.0)
        with Tab(server.url) as follower:
            follower.uuid("Edit here")
            first = (27.0, 15.0)
            follower.wait(
                lambda: (follower.value(LENGTH), follower.value(RADIUS)) == first, 30, "as at first"
            )
            # The editor is asked whether it is there: who left meanwhile would be replaced.
            editor.answer(10.0)
            yield editor, follower


def saved(server: Server, *names: str) -> Any:
    """A value of the autosaved design."""
    value: Any = tomllib.loads((server.project / "designs" / "autosave.toml").read_text())
    for name in names:
        value = value.get(name, {})
    return value


FROZEN = """
import sys, time
from workbench.proof.benchmarks.tab import Tab
tab = Tab(sys.argv[1])
tab.uuid("Straight length mm")
print("here", flush=True)
time.sleep(600)
"""
"""A tab in a process of its own, to be stopped with its connection open."""


def test_a_tab_edits_in_place_of_one_that_is_gone_without_a_word(server: Server) -> None:
    """The editor's process is frozen, its connection stands: who comes next edits in 10 s."""
    command = [sys.executable, "-c", FROZEN, server.url]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            assert process.stdout.readline() == "here\n"
            process.send_signal(signal.SIGSTOP)
            began = time.monotonic()
            with Tab(server.url) as tab:
                tab.uuid("Edit here")
                tab.wait(lambda: not tab.find("Edit here"), 10, "it edits")
                tab.set(LENGTH, 23.0)
                wait_until(lambda: saved(server, "shape", "cylinder_mm") == 23.0, 10, "it is taken")
            assert time.monotonic() - began < 20.0
        finally:
            process.kill()


def test_of_two_servers_on_a_project_one_writes(
    unpressed_project: Path, start_server: Start
) -> None:
    """The second shows, names the first and writes nothing, until it takes over; a dead one's
    project is free.
    """
    server = start_server(unpressed_project)
    with Tab(server.url) as first:
        first.set(LENGTH, 21.0)
        wait_until(lambda: saved(server, "shape", "cylinder_mm") == 21.0, 10, "the first saves")
        second = start_server(server.project)
        wait_until(lambda: server.url in second.log.read_text(), 20, "it names the first")
        with Tab(second.url) as other:
            other.uuid("Take over")
            assert any(server.url in str(widget) for widget in other.widgets.values())
            other.set(LENGTH, 30.0)
            other.wait(
                lambda: other.has_seen("Another workbench has this project"), 5, "it is told"
            )
            time.sleep(1.5)
            assert saved(server, "shape", "cylinder_mm") == 21.0
            first.set(LENGTH, 22.0)
            wait_until(lambda: saved(server, "shape", "cylinder_mm") == 22.0, 10, "it edits on")
            other.click("Take over")
            other.wait(lambda: other.value(LENGTH) == 22.0, 10, "it has what was edited meanwhile")
            other.wait(lambda: other.has_seen("This tab edits now"), 10, "it is told that it edits")
            other.set(LENGTH, 30.0)
            wait_until(lambda: saved(server, "shape", "cylinder_mm") == 30.0, 10, "it writes")
            first.uuid("Take over")
            first.set(LENGTH, 24.0)
            time.sleep(1.5)
            assert saved(server, "shape", "cylinder_mm") == 30.0
    second.kill()
    third = start_server(server.project, cold=True)
    with Tab(third.url) as tab:
        tab.wait(lambda: tab.value(LENGTH) == 30.0, 20, "it begins where the killed one was")
        tab.set(LENGTH, 25.0)
        wait_until(lambda: saved(server, "shape", "cylinder_mm") == 25.0, 10, "it writes")


def test_who_waits_sees_who_edits_and_since_when(two: tuple[Tab, Tab]) -> None:
    """Browser, place and a time of day; the same once the other has taken over."""
    editor, follower = two
    note = re.compile(r"This tab follows:\*\* .+ on this machine edits since \d\d:\d\d\.")

    def noted(tab: Tab) -> bool:
        return any(note.search(str(w.get("_markdown", w))) for w in tab.widgets.values())

    follower.wait(lambda: noted(follower), 5, "it reads who edits")
    follower.click("Edit here")
    editor.wait(lambda: noted(editor), 5, "the other reads it too")


def test_a_tab_that_follows_sees_all_and_changes_nothing(
    server: Server, two: tuple[Tab, Tab]
) -> None:
    """Its slider snaps back, its button and command do nothing, it is told; it sees each edit."""
    editor, follower = two
    assert not editor.find("Edit here")
    follower.set(LENGTH, 20.0)
    follower.wait(lambda: follower.value(LENGTH) == 27.0, 5, "the slider snapped back")
    follower.wait(lambda: follower.has_seen("Another tab edits. Click"), 5, "it is told why")
    follower.trigger("Undo")
    editor.set(LENGTH, 22.0)
    follower.wait(lambda: follower.value(LENGTH) == 22.0, 5, "it sees the edit")
    wait_until(lambda: saved(server, "shape", "cylinder_mm") == 22.0, 10, "the edit is saved")
    assert editor.value(LENGTH) == 22.0


def test_take_over_and_leave(server: Server, two: tuple[Tab, Tab]) -> None:
    """The former editor follows and is told; when the new one leaves, it edits again."""
    editor, follower = two
    follower.click("Edit here")
    editor.wait(lambda: editor.find("Edit here"), 5, "the former editor follows")
    assert editor.has_seen("Another tab took over")
    follower.wait(lambda: not follower.find("Edit here"), 5, "the other edits")
    editor.set(LENGTH, 20.0)
    editor.wait(lambda: editor.value(LENGTH) == 27.0, 5, "its slider snaps back")
    follower.set(LENGTH, 21.0)
    editor.wait(lambda: editor.value(LENGTH) == 21.0, 5, "it sees the other's edit")
    follower.close()
    editor.wait(lambda: not editor.find("Edit here"), 10, "it edits again")
    editor.set(LENGTH, 23.0)
    wait_until(lambda: saved(server, "shape", "cylinder_mm") == 23.0, 10, "its edit is taken")


def wait_for_its_place(tab: Tab, other: Tab, length_mm: float) -> None:
    """Its widgets come before it is told whether it edits: it does once the other has its edit."""
    tab.set(LENGTH, length_mm)
    tab.wait(
        lambda: tab.find("Edit here") or other.value(LENGTH) == length_mm, 30, "it edits or follows"
    )


def test_a_reload_keeps_the_place_of_the_editor(server: Server, two: tuple[Tab, Tab]) -> None:
    """The tab that comes within seconds of the editor's leaving edits; the follower follows on."""
    editor, follower = two
    with contextlib.ExitStack() as tabs:
        for length_mm in (24.0, 25.0, 26.0):
            left = time.monotonic()
            editor.close()
            reloaded = tabs.enter_context(Tab(server.url))
            wait_for_its_place(reloaded, follower, length_mm)
            in_time = time.monotonic() - left < RELOAD_S
            time.sleep(RELOAD_S + 1.0)
            if in_time:
                break
            # A busy machine was too slow for the page to be back in time: once more.
            if reloaded.find("Edit here"):
                editor, follower = follower, reloaded
            else:
                editor = reloaded
        assert in_time
        assert not reloaded.find("Edit here")
        assert follower.find("Edit here")


def test_racing_edits_end_in_one_good_state(server: Server, two: tuple[Tab, Tab]) -> None:
    """Two sliders at once with undo between: widgets, the other tab and the file agree."""
    editor, follower = two
    for step in range(30):
        editor.set(LENGTH, 20.0 + 0.2 * step)
        editor.set(RADIUS, 12.0 + 0.05 * step)
        if step % 7 == 3:
            editor.trigger("Undo")

    def agree() -> bool:
        return all(
            who.value(label) == saved(server, "shape", name)
            for who in (editor, follower)
            for label, name in ((LENGTH, "cylinder_mm"), (RADIUS, "outer_radius_mm"))
        )

    wait_until(agree, 30, "both tabs and the file agree")
    # It is the end, not a moment on the way.
    time.sleep(3.0)
    assert agree()
    assert "Internal error" not in str(editor.seen)
    assert "Traceback" not in server.log.read_text()


def test_no_click_overtakes_the_edit_before_it(two: tuple[Tab, Tab]) -> None:
    """Value and Undo in quick turns, while bodies are built: each Undo takes its own edit back."""
    editor, follower = two
    for step in range(40):
        editor.set(LENGTH, 20.0 + 0.1 * step)
        editor.trigger("Undo")
    editor.set(RADIUS, 14.0)
    follower.wait(lambda: follower.value(RADIUS) == 14.0, 30, "the last edit arrived")
    follower.wait(lambda: follower.value(LENGTH) == 27.0, 30, "every edit was undone")


def test_an_edit_of_the_last_moment_survives_a_stop_in_mid_job(
    tmp_path: Path, start_server: Start
) -> None:
    """Ctrl-C during a press, at once after an edit: the restart has the edit."""
    server = start_server(coarse_project(tmp_path), cold=True)
    with Tab(server.url) as editor:
        editor.uuid(LENGTH)
        wait_until(lambda: editor.has_seen("press: started"), 30, "the example is being pressed")
        with Tab(server.url) as follower:
            uuid = follower.uuid(LENGTH)
            editor.set(LENGTH, 20.0)
            follower.wait(lambda: follower.widgets[uuid].get("value") == 20.0, 10, "it arrived")
        time.sleep(0.2)
        server.stop()
    assert saved(server, "shape", "cylinder_mm") == 20.0
    again = start_server(server.project)
    with Tab(again.url) as tab_again:
        tab_again.wait(
            lambda: tab_again.find(LENGTH) and tab_again.value(LENGTH) == 20.0, 20, "it is there"
        )


def test_a_reload_in_mid_job_shows_progress_and_then_the_result(
    tmp_path: Path, page: Any, start_server: Start
) -> None:
    """The job goes on without the page; the new page shows its bar, then its image.

    A press of 60 frames: one of 2 was over sooner than the page was open again.
    """
    server = start_server(coarse_project(tmp_path, frames=60), cold=True)
    open_page(page, server.url)
    button(page, "Cancel").wait_for(timeout=60_000)
    page.reload()
    tab(page, "Shape").wait_for()
    button(page, "Cancel").wait_for(timeout=30_000)
    assert not button(page, "Edit here").is_visible()
    wait_until(lambda: page.get_by_text("Image ✓").count(), 150, "the result is shown")
    page.locator("img:visible").first.wait_for()
