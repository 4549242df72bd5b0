"""The conductor: newest request wins, every ended request is told once, busy is exact."""

from __future__ import annotations

import queue
import threading
import time
from pathlib import Path
from typing import cast

import numpy as np
import pytest

from workbench.core.base.errors import Cancelled, DamagedError, MeshingError
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import SensorDesign
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact
from workbench.live.conductor import Conductor
from workbench.live.live_press import LiveCall, PressPreview
from workbench.live.preview_call import PreviewCall
from workbench.live.requests import LIVE, SHAPE, Finished, PreviewDone, StageDone
from workbench.pipeline.stage import Call, Outcome
from workbench.pipeline.store import Store

WAIT_S = 5.0
"""Far beyond what a thread needs to wake."""


class Slow:
    """A runner whose calls last until they are stopped, or released one by one."""

    def __init__(self) -> None:
        self.begun: queue.Queue[Call] = queue.Queue()
        self.release = threading.Event()

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        self.begun.put(call)
        while not self.release.wait(0.005):
            monitor(0.1)
        return Outcome(stage=call.stage, key=call.key, cached=False, seconds=0.0)

    def preview(self, call: PreviewCall, monitor: Monitor) -> PressPreview:
        raise AssertionError("no live press was asked for")

    def close(self) -> None:
        self.release.set()


@pytest.fixture
def slow() -> Slow:
    return Slow()


@pytest.fixture
def conductor(tmp_path_factory: pytest.TempPathFactory, slow: Slow) -> Conductor:
    return Conductor(Store(tmp_path_factory.mktemp("store")), slow)


def design(name: str) -> SensorDesign:
    return SensorDesign(name=name)


def submit(conductor: Conductor, job: str, name: str) -> None:
    conductor.submit(job, design(name), PressCase(), ("build",))


def finished(conductor: Conductor) -> Finished:
    """The next request that ended."""
    while True:
        event = conductor.events.get(timeout=WAIT_S)
        if isinstance(event, Finished):
            return event


def test_newer_press_stops_the_running_one(conductor: Conductor, slow: Slow) -> None:
    """The first ends as superseded, the second runs to its end; busy until then."""
    submit(conductor, "press", "first")
    slow.begun.get(timeout=WAIT_S)
    submit(conductor, "press", "second")
    stopped = finished(conductor)
    assert stopped.request.design.name == "first"
    assert stopped.superseded
    assert isinstance(stopped.error, Cancelled)
    assert conductor.busy
    slow.begun.get(timeout=WAIT_S)
    slow.release.set()
    done = finished(conductor)
    assert (done.request.design.name, done.error, done.superseded) == ("second", None, False)
    assert not conductor.busy


def test_a_request_replaced_before_it_began_ends_too(conductor: Conductor, slow: Slow) -> None:
    """Of three the second never begins; whoever waits for it hears that a newer one came."""
    submit(conductor, "press", "first")
    slow.begun.get(timeout=WAIT_S)
    with conductor._threads["press"]._wake:  # pyright: ignore[reportPrivateUsage]
        # The first cannot end meanwhile, so that the second has to wait.
        submit(conductor, "press", "second")
        submit(conductor, "press", "third")
    slow.begun.get(timeout=WAIT_S)
    slow.release.set()
    ends = [finished(conductor) for _ in range(3)]
    assert [(e.request.design.name, e.superseded) for e in ends] == [
        ("second", True),
        ("first", True),
        ("third", False),
    ]


def test_the_stage_that_failed_is_named(tmp_path: Path) -> None:
    """The body is built and its mesh fails: the end names `mesh`, the second of the two."""

    class Failing(Slow):
        def run(self, call: Call, monitor: Monitor) -> Outcome:
            if call.stage == "mesh":
                raise MeshingError("no mesh")
            return Outcome(stage=call.stage, key=call.key, cached=False, seconds=0.0)

    conductor = Conductor(Store(tmp_path), Failing())
    conductor.submit("mesh", design("any"), PressCase(), ("mesh",))
    end = finished(conductor)
    assert (end.failed, type(end.error)) == ("mesh", MeshingError)


def test_a_stage_that_is_done_twice_ends_well(tmp_path: Path) -> None:
    """The mesher finds the body damaged: it is built anew, and the mesh is made."""

    class Healing(Slow):
        healed = False

        def run(self, call: Call, monitor: Monitor) -> Outcome:
            if call.stage == "mesh" and not self.healed:
                self.healed = True
                raise DamagedError("the stored result is damaged", at="build")
            return Outcome(stage=call.stage, key=call.key, cached=False, seconds=0.0)

    conductor = Conductor(Store(tmp_path), Healing())
    conductor.submit("mesh", design("any"), PressCase(), ("mesh",))
    done = []
    while not isinstance(event := conductor.events.get(timeout=WAIT_S), Finished):
        if isinstance(event, StageDone):
            done.append(event.outcome.stage)
    assert (event.error, event.failed) == (None, "")
    assert done == ["build", "build", "mesh"]


def test_live_body_is_not_stopped_by_the_next(conductor: Conductor, slow: Slow) -> None:
    """Of three slider positions the first and the last are computed, both without an error."""
    submit(conductor, SHAPE, "first")
    slow.begun.get(timeout=WAIT_S)
    submit(conductor, SHAPE, "second")
    submit(conductor, SHAPE, "third")
    slow.release.set()
    ends = [finished(conductor), finished(conductor)]
    assert [(e.request.design.name, e.error) for e in ends] == [("first", None), ("third", None)]


def test_cancel_leaves_the_live_body_alone(conductor: Conductor, slow: Slow) -> None:
    """Cancel ends the press and not the body; closing ends both."""
    submit(conductor, SHAPE, "body")
    submit(conductor, "press", "press")
    for _ in range(2):
        slow.begun.get(timeout=WAIT_S)
    conductor.cancel()
    end = finished(conductor)
    assert (end.job, end.superseded) == ("press", False)
    assert isinstance(end.error, Cancelled)
    assert conductor.busy
    conductor.cancel(following=True)
    assert finished(conductor).job == SHAPE
    assert not conductor.busy


def test_cancelled_waiting_request_is_told(conductor: Conductor, slow: Slow) -> None:
    """A request cancelled before it began ends once, as cancelled, and nothing stays busy."""
    submit(conductor, SHAPE, "running")
    slow.begun.get(timeout=WAIT_S)
    submit(conductor, SHAPE, "waiting")
    conductor.cancel(following=True)
    names = {(e.request.design.name, type(e.error)) for e in (finished(conductor) for _ in "ab")}
    assert names == {("running", Cancelled), ("waiting", Cancelled)}
    assert not conductor.busy


def test_cancel_at_once_never_leaves_a_job_busy(conductor: Conductor) -> None:
    """Wherever the thread stands when Cancel comes, each request ends once and all is free."""
    for number in range(20):
        submit(conductor, "press", str(number))
        time.sleep(0.0005 * (number % 4))
        conductor.cancel()
        assert isinstance(finished(conductor).error, Cancelled)
        assert not conductor.busy
    assert conductor.events.empty()


class Previewing(Slow):
    """A runner whose stages are done at once and whose live presses last until released."""

    def __init__(self) -> None:
        super().__init__()
        self.depths_mm: queue.Queue[float] = queue.Queue()

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        return Outcome(stage=call.stage, key=call.key, cached=True, seconds=0.0)

    def preview(self, call: PreviewCall, monitor: Monitor) -> PressPreview:
        assert isinstance(call, LiveCall)
        self.depths_mm.put(call.press.depth_mm)
        while not self.release.wait(0.005):
            monitor(0.1)
        return PressPreview(
            contact=cast("Contact", None),
            images=np.zeros((2, 1, 1, 3), np.uint8),
            seconds=0.0,
            words=f"{call.press.depth_mm}",
        )


def test_of_many_drags_the_first_is_stopped_and_only_the_last_is_pressed(tmp_path: Path) -> None:
    """Twenty moves while a live press runs: that one is stopped, 18 never begin, one is shown."""
    runner = Previewing()
    conductor = Conductor(Store(tmp_path), runner)

    def drag(depth_mm: float) -> None:
        case = PressCase(press=Press(depth_mm=depth_mm))
        conductor.press_live(design("finger"), case)

    drag(1.0)
    assert runner.depths_mm.get(timeout=WAIT_S) == 1.0
    # Under the lock of the conductor, so that the thread sees them as one burst.
    thread = conductor._threads[LIVE]  # pyright: ignore[reportPrivateUsage]
    with thread._wake:  # pyright: ignore[reportPrivateUsage]
        for step in range(20):
            drag(1.0 + 0.01 * (step + 1))
    assert finished(conductor).superseded
    assert runner.depths_mm.get(timeout=WAIT_S) == pytest.approx(1.2)
    runner.release.set()
    shown = next(
        event for event in iter(conductor.events.get, None) if isinstance(event, PreviewDone)
    )
    assert shown.request.case.press.depth_mm == pytest.approx(1.2)
    assert finished(conductor).error is None
    assert runner.depths_mm.empty()


def test_what_follows_the_hand_gives_way_once_it_takes_long(
    conductor: Conductor, slow: Slow, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A shape under the patience goes on beside a newer request; beyond it, it is stopped."""
    monkeypatch.setattr("workbench.live.job_thread.PATIENCE_S", 0.8)
    conductor.submit(SHAPE, design("first"), PressCase(), ("build",))
    slow.begun.get(timeout=WAIT_S)
    began = time.monotonic()
    conductor.submit(
        SHAPE, design("first").replace("shape.cylinder_mm", 20.0), PressCase(), ("build",)
    )
    ended = finished(conductor)
    assert ended.superseded and ended.request.design.name == "first"
    assert time.monotonic() - began > 0.5
    slow.begun.get(timeout=WAIT_S)
    conductor.cancel()
    time.sleep(1.0)
    assert conductor.busy, "Cancel is not meant for a shape that has just begun"
    conductor.cancel()
    assert isinstance(finished(conductor).error, Cancelled)


def test_a_shape_that_nobody_waits_for_is_stopped(
    conductor: Conductor, slow: Slow, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An edit taken back: its long build ends without a newer request."""
    monkeypatch.setattr("workbench.live.job_thread.PATIENCE_S", 0.1)
    conductor.submit(SHAPE, design("first"), PressCase(), ("build",))
    slow.begun.get(timeout=WAIT_S)
    conductor.give_up(SHAPE)
    assert finished(conductor).superseded


def test_cancels_are_counted_between_two_requests_too(conductor: Conductor, slow: Slow) -> None:
    """One while a request runs, one while none does; a job never asked for has none."""
    assert conductor.cancels("press") == 0
    submit(conductor, "press", "first")
    slow.begun.get(timeout=WAIT_S)
    conductor.cancel()
    finished(conductor)
    assert not conductor.busy
    conductor.stop("press")
    assert conductor.cancels("press") == 2
