"""Runs the pipeline behind the browser: one thread per topic, newest request wins.

A topic is what the designer waits for: `shape` (the live membrane), `press`, `image`, `mould`.
Widget callbacks call `submit` and return; the browser's pump reads `events`. Nothing here touches
a widget, and nothing heavy runs in these threads: they wait for the lanes.
"""

from __future__ import annotations

import queue
import threading
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass

from workbench.core.design import SensorDesign
from workbench.core.errors import Cancelled, WorkbenchError
from workbench.lanes import LaneRunner
from workbench.pipeline import PressCase, evaluate
from workbench.stages import Outcome
from workbench.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class Request:
    """What to compute."""

    design: SensorDesign
    case: PressCase
    wanted: tuple[str, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Progress:
    """A running stage."""

    topic: str
    stage: str
    fraction: float
    note: str
    eta_s: float | None


@dataclass(frozen=True, kw_only=True, slots=True)
class StageDone:
    """A stage that finished."""

    topic: str
    outcome: Outcome
    request: Request


@dataclass(frozen=True, kw_only=True, slots=True)
class Finished:
    """A request that ended; `error` is None when all of it was computed."""

    topic: str
    request: Request
    error: WorkbenchError | None
    seconds: float


Event = Progress | StageDone | Finished


class Conductor:
    """Keeps one thread per topic and the lanes they share."""

    def __init__(self, store: Store, runner: LaneRunner) -> None:
        self.store = store
        self.events: queue.Queue[Event] = queue.Queue()
        self.runner = runner
        self._topics: dict[str, _Topic] = {}
        self._guard = threading.Lock()

    def submit(
        self, topic: str, design: SensorDesign, case: PressCase, wanted: Sequence[str]
    ) -> None:
        """Ask for stages; a request of the same topic that has not begun is replaced."""
        with self._guard:
            if topic not in self._topics:
                self._topics[topic] = _Topic(topic, self)
            self._topics[topic].submit(Request(design=design, case=case, wanted=tuple(wanted)))

    def cancel(self) -> None:
        """Stop what runs and forget what waits, in every topic."""
        with self._guard:
            for topic in self._topics.values():
                topic.cancel()

    @property
    def busy(self) -> bool:
        """Whether anything runs or waits."""
        return any(topic.busy for topic in list(self._topics.values()))

    def close(self) -> None:
        """Stop everything and end the worker processes."""
        self.cancel()
        self.runner.close()


class _Topic:
    """One thread that works off the newest request."""

    def __init__(self, name: str, conductor: Conductor) -> None:
        self.name = name
        self.conductor = conductor
        self.busy = False
        self._next: Request | None = None
        self._wake = threading.Condition()
        self._stop = threading.Event()
        threading.Thread(target=self._loop, name=f"topic-{name}", daemon=True).start()

    def submit(self, request: Request) -> None:
        with self._wake:
            self._next = request
            self.busy = True
            self._wake.notify()

    def cancel(self) -> None:
        with self._wake:
            self._next = None
            self._stop.set()

    def _loop(self) -> None:
        while True:
            with self._wake:
                self._wake.wait_for(lambda: self._next is not None)
                request, self._next = self._next, None
                self._stop.clear()
            if request is not None:
                self._work(request)
            with self._wake:
                self.busy = self._next is not None

    def _work(self, request: Request) -> None:
        started = time.monotonic()
        error: WorkbenchError | None = None
        events = self.conductor.events
        try:
            for outcome in evaluate(
                request.design,
                request.case,
                self.conductor.runner,
                wanted=request.wanted,
                monitor=_Reporter(self.name, events, self._stop),
            ):
                events.put(StageDone(topic=self.name, outcome=outcome, request=request))
        except WorkbenchError as raised:
            error = raised
        except Exception as bug:
            # The thread must outlive a bug, and the designer must hear of it.
            error = WorkbenchError(f"internal error: {bug!r}", hint=traceback.format_exc())
        seconds = time.monotonic() - started
        events.put(Finished(topic=self.name, request=request, error=error, seconds=seconds))


class _Reporter:
    """Turns a stage's progress into events with an estimate of the time left."""

    def __init__(self, topic: str, events: queue.Queue[Event], stop: threading.Event) -> None:
        self.topic = topic
        self.events = events
        self.stop = stop
        self.stage = ""
        self.began = 0.0
        self.sent = 0.0

    def __call__(self, stage: str, fraction: float, note: str) -> None:
        if self.stop.is_set():
            raise Cancelled("cancelled by the user")
        now = time.monotonic()
        if stage != self.stage:
            self.stage, self.began, self.sent = stage, now, 0.0
        if now - self.sent < 0.1:
            return
        self.sent = now
        left = (now - self.began) * (1 - fraction) / fraction if fraction > 0.02 else None
        self.events.put(
            Progress(topic=self.topic, stage=stage, fraction=fraction, note=note, eta_s=left)
        )
