"""Runs the pipeline behind the browser: one thread per job, newest request wins.

A job is what the designer waits for: `shape` (the body that follows the sliders), `press`,
`image`, `maps`, `mesh`, `tetrahedra`, `parts`, `import`, `object`, and what follows the hand:
those that `requests` names.
Widget callbacks call `submit` and return; the browser's pump reads `events`. Nothing here touches
a widget, and nothing heavy runs in these threads: they wait for the lanes.
"""

from __future__ import annotations

import contextlib
import queue
import threading
from collections.abc import Sequence

from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.live.job_thread import JobThread, Runner
from workbench.live.live_press import live_call, live_design
from workbench.live.preview_call import PreviewCall
from workbench.live.requests import LIVE, Event, Request
from workbench.pipeline.store import Store


class Conductor:
    """Keeps one thread per job and the lanes they share."""

    def __init__(self, store: Store, runner: Runner) -> None:
        self.store = store
        self.events: queue.Queue[Event] = queue.Queue()
        self.runner = runner
        self._threads: dict[str, JobThread] = {}
        self._guard = threading.Lock()

    def submit(
        self, job: str, design: SensorDesign, case: PressCase, wanted: Sequence[str]
    ) -> Request:
        """Ask for stages; a request of the same job that has not begun is replaced.

        One that runs is stopped, except in jobs that follow the hand: it is done before a person
        could wait for it, and a slider that moves on would otherwise never see a body.
        """
        return self._submit(job, Request(design=design, case=case, wanted=tuple(wanted)))

    def press_live(self, design: SensorDesign, case: PressCase) -> None:
        """Ask for a live press; the one that runs is stopped, and none ever waits in line."""
        self.ask(LIVE, live_design(design), case, live_call(design, case))

    def ask(self, job: str, design: SensorDesign, case: PressCase, call: PreviewCall) -> Request:
        """Ask for a preview and what it needs; a request of the same job is replaced."""
        request = Request(design=design, case=case, wanted=call.needs, preview=call)
        return self._submit(job, request)

    def stop_live(self) -> None:
        """Stop the live press that runs, if any."""
        self.stop(LIVE)

    def stop(self, job: str) -> None:
        """Stop what one job computes, and forget what waits in it."""
        with self._guard:
            if job in self._threads:
                self._threads[job].cancel()

    def cancels(self, job: str) -> int:
        """How often a job was told to stop; who asks for one thing after another compares it."""
        with self._guard:
            return self._threads[job].cancels if job in self._threads else 0

    def _submit(self, job: str, request: Request) -> Request:
        with self._guard:
            if job not in self._threads:
                self._threads[job] = JobThread(job, self.runner, self.events)
            self._threads[job].submit(request)
        return request

    def wait(self, seconds: float) -> list[Event]:
        """All events that have come, after at most that time without any [s]."""
        found: list[Event] = []
        with contextlib.suppress(queue.Empty):
            found.append(self.events.get(timeout=seconds))
            while True:
                found.append(self.events.get_nowait())
        return found

    def cancel(self, *, following: bool = False) -> None:
        """Stop what runs and forget what waits; what follows the hand only when it takes long."""
        with self._guard:
            for thread in self._threads.values():
                if following or not thread.spared:
                    thread.cancel()

    def works_on(self, job: str) -> bool:
        """Whether a request of this job runs or waits."""
        with self._guard:
            return job in self._threads and self._threads[job].busy

    def give_up(self, *jobs: str) -> None:
        """Nobody waits for these any more: what waits is forgotten, what takes long is stopped."""
        with self._guard:
            for name in jobs:
                if name in self._threads:
                    self._threads[name].give_up()

    @property
    def busy(self) -> bool:
        """Whether anything runs or waits."""
        with self._guard:
            return any(thread.busy for thread in self._threads.values())

    def close(self) -> None:
        """Stop everything and end the worker processes."""
        self.cancel(following=True)
        self.runner.close()
