"""A sweep that runs: its points come one after the other, and Cancel is never lost."""

from __future__ import annotations

import threading
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tests.unit.test_conductor import WAIT_S, Previewing
from tests.unit.test_jobs import Told
from tests.unit.test_sweeps import walls
from ui.desk.jobs import Jobs
from ui.desk.sweep_run import JOB, SweepRun
from workbench.core.base.errors import MeshingError
from workbench.core.base.monitor import Monitor
from workbench.live.conductor import Conductor
from workbench.live.requests import Finished
from workbench.pipeline.stage import Call, Outcome
from workbench.project.project import Project
from workbench.variants.sweep_files import load_sweep, save_sweep
from workbench.variants.sweeps import Status


class Quick(Previewing):
    """A runner whose stages are done at once, or fail."""

    def __init__(self) -> None:
        super().__init__()
        self.held = threading.Event()
        self.held.set()
        self.fails = False

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        monitor(0.5)
        assert self.held.wait(WAIT_S)
        monitor(0.5)
        if self.fails:
            raise MeshingError("no mesh")
        return super().run(call, monitor)


class Bench:
    """A sweep of three walls in a project, and the pump of its jobs, turned by hand."""

    def __init__(self, folder: Path) -> None:
        self.project = Project(folder)
        self.runner = Quick()
        self.conductor = Conductor(self.project.store, self.runner)
        reports: Any = Told()
        reports.notify = lambda title, text: None
        header: Any = SimpleNamespace(show_progress=lambda running: None)
        self.jobs = Jobs(self.conductor, reports, header)
        self.run = SweepRun(self.project, self.jobs, lambda: None)
        sweep = walls(self.project)
        save_sweep(self.project, sweep)
        self.run.open(sweep)

    def pump_point(self) -> None:
        """Handle events until a point has ended."""
        while True:
            event = self.conductor.events.get(timeout=WAIT_S)
            self.jobs.pump([event])
            if isinstance(event, Finished):
                return

    def statuses(self) -> list[Status]:
        """Of the points, as the file has them."""
        return [p.status for p in load_sweep(self.project, "elastomer_mm 1").points]


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path)


def wait_idle(bench: Bench) -> None:
    """Until the point has ended, of which nobody has heard yet."""
    pause = threading.Event()
    while bench.conductor.busy:
        pause.wait(0.005)


def test_points_come_one_after_the_other(bench: Bench) -> None:
    """Three walls: three points done, kept one by one, and the end is told."""
    bench.run.start()
    for number in range(3):
        assert bench.run.running == number
        bench.pump_point()
        assert bench.statuses().count(Status.DONE) == number + 1
    assert (bench.run.running, bench.run.left) == (None, [])
    assert bench.run.ending == "Finished: 3 points."


@pytest.mark.parametrize("by_sweep", [True, False])
def test_cancel_between_two_points_stops_what_is_left(bench: Bench, by_sweep: bool) -> None:
    """The first point has ended unheard when Cancel comes: it is kept, no other begins."""
    bench.run.start()
    wait_idle(bench)
    if by_sweep:
        bench.run.stop()
    else:
        bench.conductor.cancel()
    bench.pump_point()
    assert (bench.run.running, bench.run.left) == (None, [])
    assert bench.statuses() == [Status.DONE, Status.WAITING, Status.WAITING]
    assert bench.run.ending.startswith("Stopped")
    assert not bench.conductor.busy


def test_a_stopped_sweep_goes_on_where_it_was(bench: Bench) -> None:
    """Cancelled in its first point, then resumed: all three are done; Cancel does not linger."""
    bench.runner.held.clear()
    bench.run.start()
    bench.run.stop()
    bench.runner.held.set()
    bench.pump_point()
    assert bench.statuses() == [Status.WAITING] * 3
    bench.run.start()
    assert bench.run.ending == ""
    for _ in range(3):
        bench.pump_point()
    # The stand-in stores no images: they are done, and would be asked for again.
    assert bench.statuses() == [Status.DONE] * 3
    assert bench.run.ending == "Finished: 3 points."


def test_points_that_fail_do_not_stop_the_others(bench: Bench) -> None:
    """No mesh at any wall: three messages, and the end counts them."""
    bench.runner.fails = True
    bench.run.start()
    for _ in range(3):
        bench.pump_point()
    assert bench.statuses() == [Status.FAILED] * 3
    assert bench.run.ending == "Finished: 3 points, 3 failed."


def test_words_tell_the_point(bench: Bench) -> None:
    """While the second of three is computed: 2 of 3."""
    bench.run.start()
    bench.pump_point()
    assert bench.run.words().startswith("**2 of 3**")
    bench.conductor.stop(JOB)
    bench.pump_point()
    assert bench.run.words() == ""
