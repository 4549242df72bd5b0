"""Runs the pipeline behind the browser: one thread per topic, newest request wins.

A topic is what the designer waits for: `shape` (the body that follows the sliders), `press`,
`image`, `maps`, `mesh`, `tetrahedra`, `parts`, `import`, `object`, and what follows the hand:
those below.
Widget callbacks call `submit` and return; the browser's pump reads `events`. Nothing here touches
a widget, and nothing heavy runs in these threads: they wait for the lanes.
"""

from __future__ import annotations

import contextlib
import queue
import threading
import time
import traceback
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Protocol

from workbench.core.design import SensorDesign
from workbench.core.errors import Cancelled, WorkbenchError
from workbench.core.monitor import Monitor, seconds_left
from workbench.live_press import live_call, live_design
from workbench.pipeline import PressCase, evaluate, needed, plan, stage_monitor
from workbench.preview_call import PreviewCall
from workbench.stages import Call, Outcome
from workbench.store import Store

SHAPE = "shape"
"""The topic of the body that follows the sliders."""
LIVE = "live"
"""The topic of live presses: each request stops the one before."""
GLIMPSE = "glimpse"
"""The topic of the small picture that follows the sliders."""
CUT = "cut"
"""The topic of the section view."""
DRAWN = "drawn object"
"""The topic of the object's shape in the 3D view."""
FOLLOWING = (SHAPE, GLIMPSE, CUT, DRAWN)
"""Topics too quick for a bar or a Cancel, unless one takes longer than `PATIENCE_S`."""
PATIENCE_S = 4.0
"""What follows the hand and still runs after this gives way to a newer request [s]."""
QUIET = (*FOLLOWING, LIVE)
"""Topics that follow the designer's hand: nothing is logged of them."""


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


@dataclass(frozen=True, kw_only=True, slots=True)
class Request:
    """What to compute."""

    design: SensorDesign
    case: PressCase
    wanted: tuple[str, ...]
    preview: PreviewCall | None = None
    """What is asked for once the stages are stored."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Progress:
    """A running stage."""

    topic: str
    stage: str
    fraction: float
    note: str
    eta_s: float | None
    seconds: float = 0.0
    """Since the request began [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class StageDone:
    """A stage that finished."""

    topic: str
    outcome: Outcome
    request: Request


@dataclass(frozen=True, kw_only=True, slots=True)
class PreviewDone:
    """A preview that was answered."""

    topic: str
    preview: Any
    request: Request


@dataclass(frozen=True, kw_only=True, slots=True)
class Finished:
    """A request that ended; `error` is None when all of it was computed."""

    topic: str
    request: Request
    error: WorkbenchError | None
    seconds: float
    superseded: bool = False
    """Whether it was stopped for a newer request, which is nothing to tell the designer."""
    failed: str = ""
    """Stage that raised the error; empty without one, or when no stage had begun."""


Event = Progress | StageDone | PreviewDone | Finished


class Conductor:
    """Keeps one thread per topic and the lanes they share."""

    def __init__(self, store: Store, runner: Runner) -> None:
        self.store = store
        self.events: queue.Queue[Event] = queue.Queue()
        self.runner = runner
        self._topics: dict[str, _Topic] = {}
        self._guard = threading.Lock()

    def submit(
        self, topic: str, design: SensorDesign, case: PressCase, wanted: Sequence[str]
    ) -> Request:
        """Ask for stages; a request of the same topic that has not begun is replaced.

        One that runs is stopped, except in topics that follow the hand: it is done before a person
        could wait for it, and a slider that moves on would otherwise never see a body.
        """
        return self._submit(topic, Request(design=design, case=case, wanted=tuple(wanted)))

    def press_live(self, design: SensorDesign, case: PressCase) -> None:
        """Ask for a live press; the one that runs is stopped, and none ever waits in line."""
        self.ask(LIVE, live_design(design), case, live_call(design, case))

    def ask(self, topic: str, design: SensorDesign, case: PressCase, call: PreviewCall) -> Request:
        """Ask for a preview and what it needs; a request of the same topic is replaced."""
        request = Request(design=design, case=case, wanted=call.needs, preview=call)
        return self._submit(topic, request)

    def stop_live(self) -> None:
        """Stop the live press that runs, if any."""
        self.stop(LIVE)

    def stop(self, topic: str) -> None:
        """Stop what one topic computes, and forget what waits in it."""
        with self._guard:
            if topic in self._topics:
                self._topics[topic].cancel()

    def _submit(self, topic: str, request: Request) -> Request:
        with self._guard:
            if topic not in self._topics:
                self._topics[topic] = _Topic(topic, self)
            self._topics[topic].submit(request)
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
            for topic in self._topics.values():
                if following or topic.name not in FOLLOWING or topic.seconds > PATIENCE_S:
                    topic.cancel()

    def give_up(self, *topics: str) -> None:
        """Nobody waits for these any more: what waits is forgotten, what takes long is stopped."""
        with self._guard:
            for name in topics:
                if name in self._topics:
                    self._topics[name].give_up()

    @property
    def busy(self) -> bool:
        """Whether anything runs or waits."""
        with self._guard:
            return any(topic.busy for topic in self._topics.values())

    def close(self) -> None:
        """Stop everything and end the worker processes."""
        self.cancel(following=True)
        self.runner.close()


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


class _Topic:
    """One thread that works off the newest request."""

    def __init__(self, name: str, conductor: Conductor) -> None:
        self.name = name
        self.conductor = conductor
        self._next: Request | None = None
        self._stop: _Stop | None = None
        self._wanted = True
        """Whether anybody waits for what runs."""
        self._wake = threading.Condition()
        threading.Thread(target=self._loop, name=f"topic-{name}", daemon=True).start()

    @property
    def busy(self) -> bool:
        """Whether a request runs or waits."""
        with self._wake:
            return self._next is not None or self._stop is not None

    @property
    def seconds(self) -> float:
        """How long the running request has taken so far [s]; 0 when none runs."""
        with self._wake:
            return 0.0 if self._stop is None else self._stop.seconds

    def outdated(self, stop: _Stop) -> bool:
        """Whether what runs has taken long and something newer is wanted in its place."""
        with self._wake:
            unwanted = self._next is not None or not self._wanted
            return self.name in FOLLOWING and unwanted and stop.seconds > PATIENCE_S

    def give_up(self) -> None:
        with self._wake:
            self._next, self._wanted = None, False

    def submit(self, request: Request) -> None:
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
        with self._wake:
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
        self.conductor.events.put(
            Finished(
                topic=self.name,
                request=request,
                error=error,
                seconds=seconds,
                superseded=superseded,
                failed=failed,
            )
        )

    def _work(self, request: Request, stop: _Stop) -> None:
        error: WorkbenchError | None = None
        events = self.conductor.events
        waiting: list[str] = []
        reporter = _Reporter(self, events, stop)
        try:
            waiting = needed(plan(request.design, request.case), request.wanted)
            for outcome in evaluate(
                request.design,
                request.case,
                self.conductor.runner,
                wanted=request.wanted,
                monitor=reporter,
            ):
                waiting.pop(0)
                events.put(StageDone(topic=self.name, outcome=outcome, request=request))
            if request.preview is not None:
                call = request.preview
                preview = self.conductor.runner.preview(call, stage_monitor(reporter, call.stage))
                events.put(PreviewDone(topic=self.name, preview=preview, request=request))
        except WorkbenchError as raised:
            error = raised
        except Exception as bug:
            # The thread must outlive a bug, and the designer must hear of it.
            error = WorkbenchError(f"internal error: {bug!r}", hint=traceback.format_exc())
        superseded = stop.superseded and isinstance(error, Cancelled)
        seconds = stop.seconds
        with self._wake:
            # Together, so that whoever reads the event finds the topic free.
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

    def __init__(self, topic: _Topic, events: queue.Queue[Event], stop: _Stop) -> None:
        self.topic = topic
        self.events = events
        self.stop = stop
        self.stage = ""
        self.began = 0.0
        self.sent = 0.0

    def __call__(self, stage: str, fraction: float, note: str) -> None:
        if not self.stop.asked and self.topic.outdated(self.stop):
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
                topic=self.topic.name,
                stage=stage,
                fraction=fraction,
                note=note,
                eta_s=left,
                seconds=self.stop.seconds,
            )
        )
