"""One job of the conductor: a thread that works off the newest request and tells of it.

Nothing heavy runs in it: it waits for the runner. Every request ends in exactly one `Finished`, but
those of the hand that were replaced before they began, for which nobody waits.
"""

from __future__ import annotations

import queue
import threading
import time
import traceback
from typing import Any, Protocol

from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.core.base.monitor import Monitor, seconds_left
from workbench.live.preview_call import PreviewCall
from workbench.live.requests import (
    FOLLOWING,
    PATIENCE_S,
    QUIET,
    Event,
    Finished,
    PreviewDone,
    Progress,
    Request,
    StageDone,
)
from workbench.pipeline.stage import Call, Outcome
from workbench.planning.plan import evaluate, needed, plan, stage_monitor


class Runner(Protocol):
    """Where stages run: the lanes, or a stand-in of a test."""

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call unless it is stored."""
        ...

    def preview(self, call: PreviewCall, monitor: Monitor) -> Any:
        """Compute a preview; nothing is stored."""
        ...

    def close(self) -> None:
        """End what runs."""
        ...


class _Stop:
    """Asks one running request to end."""

    def __init__(self) -> None:
        self.began = time.monotonic()
        self.asked = False
        self.superseded = False

    @property
    def seconds(self) -> float:
        """How long the request has run [s]."""
        return time.monotonic() - self.began


class JobThread:
    """The thread of one job: it works off the newest request."""

    def __init__(self, name: str, runner: Runner, events: queue.Queue[Event]) -> None:
        self.name = name
        self.runner = runner
        self.events = events
        self.cancels = 0
        """How often it was told to stop."""
        self._next: Request | None = None
        self._stop: _Stop | None = None
        self._wanted = True
        """Whether anybody waits for what runs."""
        self._wake = threading.Condition()
        threading.Thread(target=self._loop, name=f"job-{name}", daemon=True).start()

    @property
    def busy(self) -> bool:
        """Whether a request runs or waits."""
        with self._wake:
            return self._next is not None or self._stop is not None

    @property
    def spared(self) -> bool:
        """Whether Cancel is not meant for it: it follows the hand, and does not take long."""
        with self._wake:
            took_s = 0.0 if self._stop is None else self._stop.seconds
            return self.name in FOLLOWING and took_s <= PATIENCE_S

    def outdated(self, stop: _Stop) -> bool:
        """Whether what runs has taken long and something newer is wanted in its place."""
        with self._wake:
            unwanted = self._next is not None or not self._wanted
            return self.name in FOLLOWING and unwanted and stop.seconds > PATIENCE_S

    def give_up(self) -> None:
        """Nobody waits any more: forget what waits, and let what takes long be stopped."""
        with self._wake:
            self._next, self._wanted = None, False

    def submit(self, request: Request) -> None:
        """Take a request in place of one that waits, and stop the one that runs."""
        with self._wake:
            self._wanted = True
            replaced, self._next = self._next, request
            if replaced is not None and self.name not in QUIET:
                # Whoever waits for it must not wait for ever; nobody waits for the hand's.
                error = Cancelled("superseded before it began")
                self._finished(replaced, error, seconds=0.0, superseded=True)
            if self._stop is not None and not self._stop.asked and self.name not in FOLLOWING:
                self._stop.superseded = True
                self._stop.asked = True
            self._wake.notify()

    def cancel(self) -> None:
        """Stop what runs and forget what waits."""
        with self._wake:
            self.cancels += 1
            waiting, self._next = self._next, None
            if self._stop is not None:
                self._stop.asked = True
            if waiting is not None:
                error = Cancelled("cancelled before it began")
                self._finished(waiting, error, seconds=0.0)

    def _loop(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._next is not None)
                request, self._next = self._next, None
                self._stop = stop = _Stop()
            if request is not None:
                self._work(request, stop)

    def _finished(
        self,
        request: Request,
        error: WorkbenchError | None,
        *,
        seconds: float,
        superseded: bool = False,
        failed: str = "",
    ) -> None:
        self.events.put(
            Finished(
                job=self.name,
                request=request,
                error=error,
                seconds=seconds,
                superseded=superseded,
                failed=failed,
            )
        )

    def _work(self, request: Request, stop: _Stop) -> None:
        error: WorkbenchError | None = None
        waiting: list[str] = []
        reporter = _Reporter(self, self.events, stop)
        try:
            waiting = needed(plan(request.design, request.case), request.wanted)
            for outcome in evaluate(
                request.design,
                request.case,
                self.runner,
                wanted=request.wanted,
                monitor=reporter,
            ):
                # A stage whose input was found damaged is done twice.
                if outcome.stage in waiting:
                    waiting.remove(outcome.stage)
                self.events.put(StageDone(job=self.name, outcome=outcome, request=request))
            if request.preview is not None:
                call = request.preview
                preview = self.runner.preview(call, stage_monitor(reporter, call.stage))
                self.events.put(PreviewDone(job=self.name, preview=preview, request=request))
        except WorkbenchError as raised:
            error = raised
        except Exception as bug:
            # The thread must outlive a bug, and the designer must hear of it.
            error = WorkbenchError(f"internal error: {bug!r}", hint=traceback.format_exc())
        superseded = stop.superseded and isinstance(error, Cancelled)
        seconds = stop.seconds
        with self._wake:
            # Together, so that whoever reads the event finds the thread free.
            self._stop = None
            self._finished(
                request,
                error,
                seconds=seconds,
                superseded=superseded,
                failed=waiting[0] if error is not None and waiting else "",
            )


class _Reporter:
    """Turns a stage's progress into events with an estimate of the time left."""

    def __init__(self, thread: JobThread, events: queue.Queue[Event], stop: _Stop) -> None:
        self.thread = thread
        self.events = events
        self.stop = stop
        self.stage = ""
        self.began = 0.0
        self.sent = 0.0

    def __call__(self, stage: str, fraction: float, note: str) -> None:
        if not self.stop.asked and self.thread.outdated(self.stop):
            self.stop.asked = self.stop.superseded = True
        if self.stop.asked:
            newer = "superseded by a newer request"
            raise Cancelled(newer if self.stop.superseded else "cancelled by the user")
        now = time.monotonic()
        if stage != self.stage:
            self.stage, self.began, self.sent = stage, now, 0.0
        if now - self.sent < 0.1:
            return
        self.sent = now
        left = seconds_left(now - self.began, fraction)
        self.events.put(
            Progress(
                job=self.thread.name,
                stage=stage,
                fraction=fraction,
                note=note,
                eta_s=left,
                seconds=self.stop.seconds,
            )
        )
