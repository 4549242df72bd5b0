"""What runs for the desk: requests go to the conductor, and one pump thread drains its events.

The pump wakes at once for an event and ten times a second without one; everything it does to
widgets happens under the lock that widget callbacks take.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from ui.desk.reports import Reports, in_full
from ui.page.header import Header
from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.core.base.units import human_seconds
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.live.conductor import Conductor
from workbench.live.job_words import job_words
from workbench.live.preview_call import PreviewCall
from workbench.live.requests import (
    CUT,
    DRAWN,
    FORESIGHT,
    IMAGE_PREVIEW,
    LIVE,
    PREDICTION,
    QUIET,
    SHAPE,
    TOUCH,
    Event,
    Finished,
    PreviewDone,
    Progress,
    Request,
    StageDone,
)
from workbench.pipeline.stage import Outcome
from workbench.planning.stage_table import label_of
from workbench.project.state import State

PUMP_S = 0.1
Then = Callable[[Finished], None]


class Jobs:
    """Requests of one desk and how they go."""

    def __init__(self, conductor: Conductor, reports: Reports, header: Header) -> None:
        self.conductor = conductor
        self.reports = reports
        self.header = header
        self.running: dict[str, Progress] = {}
        self.on_done: Callable[[Outcome], None] = lambda outcome: None
        """Set by the desk: shows a stage's result."""
        self.on_events: Callable[[], None] = lambda: None
        """Set by the desk: follows after events."""
        self.on_idle: Callable[[], None] = lambda: None
        """Set by the desk: called each time the pump turns."""
        self.asked_now: Callable[[Request, str], bool] = lambda request, failed: True
        """Set by the desk: whether a stage that failed still belongs to the state."""
        self.on_preview: dict[str, Callable[[Any, Request], None]] = {}
        """Who shows the previews of a job; filled by the desk and the panels."""
        self.on_failed: Callable[[WorkbenchError, str], None] = lambda error, job: None
        """Set by the desk: shows what an error leaves to look at."""
        self._then: dict[int, tuple[Request, Then]] = {}
        """Who waits for a request, by the identity of that: two of a job may be equal."""

    def submit(
        self,
        job: str,
        design: SensorDesign,
        case: PressCase,
        wanted: tuple[str, ...],
        then: Then | None = None,
    ) -> None:
        """Ask for stages; `then` takes the place of reporting how it ended."""
        if job not in QUIET:
            self.reports.log(f"{job_words(job)}: started")
        # Under the pump's lock, so that its end is not handled before it is known who waits.
        with self.reports.lock:
            self._wait(self.conductor.submit(job, design, case, wanted), then)

    def ask(self, job: str, call: PreviewCall, state: State, then: Then) -> None:
        """Ask for a preview that the designer waits for; `then` is told how it ended.

        The answer itself goes to `on_preview`, before.
        """
        self.reports.log(f"{job_words(job)}: started")
        with self.reports.lock:
            self._wait(self.conductor.ask(job, state.design, state.case, call), then)

    def _wait(self, request: Request, then: Then | None) -> None:
        if then is not None:
            self._then[id(request)] = (request, then)

    def pump_forever(self) -> None:
        """Drain events into widgets until the process ends."""
        while True:
            try:
                self.pump(self.conductor.wait(PUMP_S))
            except Exception as bug:
                self.reports.crash(bug)

    def pump(self, events: Sequence[Event]) -> None:
        """Handle events, then what waits for a quiet moment."""
        guarded = self.reports.guarded
        with self.reports.lock:
            for event in events:
                guarded(self._handle)(event)
            if events:
                self.header.show_progress(self.running)
                self.on_events()
            guarded(lambda event: self.on_idle())(None)

    def _handle(self, event: Event) -> None:
        if isinstance(event, Progress):
            self.running[event.job] = event
        elif isinstance(event, StageDone):
            outcome = event.outcome
            if not outcome.cached:
                name = label_of(outcome.stage)
                self.reports.log(f"{name} done in {human_seconds(outcome.seconds)}")
            self.on_done(outcome)
        elif isinstance(event, PreviewDone):
            self.on_preview[event.job](event.preview, event.request)
        else:
            self._finish(event)

    def _finish(self, event: Finished) -> None:
        self.running.pop(event.job, None)
        error = event.error
        _, then = self._then.pop(id(event.request), (None, None))
        log = self.reports.log
        quiet, name = event.job in QUIET, job_words(event.job)
        if event.superseded:
            if not quiet:
                # Who waited for it is not told: the newer request has its own.
                log(f"{name}: replaced by a newer request")
        elif isinstance(error, Cancelled):
            if not quiet:
                log(f"{name}: cancelled")
                text = f"{name} was stopped; earlier results are kept"
                self.reports.notify("Cancelled", text)
            if then is not None:
                then(event)
        elif then is not None:
            then(event)
        elif error is not None and event.job in (FORESIGHT, IMAGE_PREVIEW, CUT):
            # What was wrong with the design itself is told, once, by the job of its shape.
            if not event.failed:
                log(f"{name}: {in_full(error.message, error.hint)}")
            self.on_failed(error, event.job)
        elif error is not None and event.job == TOUCH:
            # The contact solver is asked instead, and tells what is wrong with the press itself.
            log(f"{name}: {in_full(error.message, error.hint)}")
            self.on_failed(error, event.job)
        elif error is not None and event.job == PREDICTION:
            # Nobody asked for it; who asks by the button is told.
            log(f"{name}: {in_full(error.message, error.hint)}")
        elif error is not None and event.job == LIVE:
            self.reports.report(error)
            self.on_failed(error, event.job)
        elif error is not None and not self.asked_now(event.request, event.failed):
            # Its message would stand above a design that it does not tell of.
            why = in_full(error.message, error.hint)
            log(f"{name}, of an earlier design: {why}")
        elif error is not None:
            self.reports.report(error, job="" if event.job in (SHAPE, DRAWN) else event.job)
            self.on_failed(error, event.job)
        elif not quiet:
            log(f"{name}: finished in {human_seconds(event.seconds)}")
