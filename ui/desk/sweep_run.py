"""A sweep that runs: point after point through the jobs, each kept in the sweep's file at once.

Widgets are the panel's; here is which point is next, and when to stop.
"""

from __future__ import annotations

import time
from collections.abc import Callable

from ui.desk.jobs import Jobs
from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.core.base.units import human_seconds
from workbench.live.requests import Finished
from workbench.planning.stage_table import label_of
from workbench.project.project import Project
from workbench.variants.sweep_files import save_sweep
from workbench.variants.sweeps import (
    Status,
    Sweep,
    done,
    failed,
    refusal,
    seconds_left,
    state_at,
    todo,
)

JOB = "sweep"


class SweepRun:
    """The points of one sweep that are left, and the one that is computed."""

    def __init__(self, project: Project, jobs: Jobs, on_change: Callable[[], None]) -> None:
        self.project = project
        self.jobs = jobs
        self.on_change = on_change
        """Told when a point begins and when the sweep has ended."""
        self.sweep: Sweep | None = None
        """What runs, or was opened."""
        self.running: int | None = None
        """Number of the point that is computed."""
        self.left: list[int] = []
        """Points to compute, the running one first."""
        self.ending = ""
        """How the run ended, for people; empty before."""
        self._began = 0.0
        self._cancels = 0

    @property
    def busy(self) -> bool:
        """Whether a point is computed."""
        return self.running is not None

    def open(self, sweep: Sweep | None) -> None:
        """Have another sweep, or none."""
        self.sweep, self.ending = sweep, ""

    def start(self) -> None:
        """Compute what the sweep lacks."""
        if self.sweep is None:
            return
        self.ending = ""
        self.left = todo(self.sweep, self.project.store)
        self._cancels = self.jobs.conductor.cancels(JOB)
        self._next()

    def stop(self) -> None:
        """Compute no more; points that are done are kept."""
        self.jobs.conductor.stop(JOB)

    def _next(self) -> None:
        """Ask for the next point; values that the design refuses fail at once."""
        while self.sweep is not None and self.left:
            number = self.left[0]
            error = refusal(self.sweep, number)
            if error is None:
                self.running, self._began = number, time.monotonic()
                state, wanted = state_at(self.sweep, number), self.sweep.wanted
                self.on_change()
                self.jobs.submit(JOB, state.design, state.case, wanted, self._ended)
                return
            self._take(failed(self.sweep, number, error))
        if self.sweep is not None:
            fails = sum(point.status is Status.FAILED for point in self.sweep.points)
            words = f", {fails} failed" if fails else ""
            self.ending = f"Finished: {len(self.sweep.points)} points{words}."
        self.running = None
        self.on_change()

    def _ended(self, finished: Finished) -> None:
        """Take a point in and go on; a cancelled sweep keeps what it has."""
        number, self.running = self.running, None
        if self.sweep is None or number is None:
            return
        stopped = isinstance(finished.error, Cancelled)
        if not stopped:
            self._take(self._outcome(self.sweep, number, finished))
        # A Cancel that came after the point's end, before that was heard of, stopped nothing.
        if self.left and (stopped or self._cancels != self.jobs.conductor.cancels(JOB)):
            self.left = []
            self.ending = "Stopped; *Resume sweep* goes on where it was."
            self.on_change()
            return
        self._next()

    def _outcome(self, sweep: Sweep, number: int, finished: Finished) -> Sweep:
        """The sweep with what came of a point."""
        if finished.error is not None:
            return failed(sweep, number, finished.error)
        try:
            return done(sweep, number, self.project.store, finished.seconds)
        except WorkbenchError as broken:
            return failed(sweep, number, broken)

    def _take(self, sweep: Sweep) -> None:
        self.sweep, self.left = sweep, self.left[1:]
        save_sweep(self.project, sweep)

    def words(self) -> str:
        """How far the sweep is, and how long it still takes; "" between two points."""
        if self.sweep is None or self.running is None:
            return ""
        eta_s = seconds_left(self.sweep, len(self.left), time.monotonic() - self._began)
        ends = f", about {human_seconds(eta_s)} left" if eta_s is not None else ""
        now = self.jobs.running.get(JOB)
        name = "" if now is None else label_of(now.stage)
        stage = "" if now is None else f" · {name} {100.0 * now.fraction:.0f} %"
        count = len(self.sweep.points)
        return f"**{count - len(self.left) + 1} of {count}**{ends}{stage}"
