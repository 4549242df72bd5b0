"""How requests end: a failed one is told where it was asked for, one of another design is not."""

from __future__ import annotations

import contextlib
import dataclasses
import threading
from types import SimpleNamespace
from typing import Any

import pytest

from ui.desk.jobs import Jobs
from workbench.core.base.errors import Cancelled, DesignError
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.live.requests import IMAGE_PREVIEW, PREDICTION, SHAPE, Finished, Request
from workbench.planning.stage_table import STAGES


class Told:
    """Reports that remember what was told."""

    def __init__(self) -> None:
        self.lock = contextlib.nullcontext(threading.RLock())
        self.errors: list[tuple[str, str]] = []
        self.lines: list[str] = []
        self.log = self.lines.append

    def guarded(self, handler: Any) -> Any:
        return handler

    def report(self, error: DesignError, *, job: str) -> None:
        self.errors.append((error.message, job))


def failed(job: str) -> Finished:
    """A request whose body could not be built."""
    request = Request(design=SensorDesign(name="any"), case=PressCase(), wanted=("press",))
    error = DesignError("no face is sensing", hint="name one")
    return Finished(job=job, request=request, error=error, seconds=1.0, failed="build")


@pytest.fixture
def told() -> Told:
    return Told()


def asked(design: SensorDesign, case: PressCase, wanted: tuple[str, ...]) -> Request:
    return Request(design=design, case=case, wanted=wanted)


@pytest.fixture
def jobs(told: Told) -> Jobs:
    reports: Any = told
    conductor: Any = SimpleNamespace(submit=lambda job, *words: asked(*words))
    header: Any = SimpleNamespace(show_progress=lambda running: None)
    return Jobs(conductor, reports, header)


@pytest.mark.parametrize(("job", "place"), [("press", "press"), ("parts", "parts"), (SHAPE, "")])
def test_a_failed_request_is_told_by_its_job(jobs: Jobs, told: Told, job: str, place: str) -> None:
    """The message goes to the button of its job; the live body has none."""
    jobs.pump([failed(job)])
    assert told.errors == [("no face is sensing", place)]


def test_an_error_of_what_nobody_asked_for_is_only_logged(jobs: Jobs, told: Told) -> None:
    """Learned forces follow a press by themselves: one line in the log, nothing red."""
    jobs.pump([failed(PREDICTION)])
    assert told.errors == []
    assert told.lines == ["forces by the network: no face is sensing. Name one."]


def test_an_error_of_another_design_is_only_logged(jobs: Jobs, told: Told) -> None:
    """After an undo the state's body is another: nothing red, one line in the log."""
    asked: list[str] = []

    def asked_now(request: Request, stage: str) -> bool:
        asked.append(stage)
        return False

    jobs.asked_now = asked_now
    jobs.pump([failed("press")])
    assert told.errors == []
    assert asked == ["build"]
    assert told.lines == ["press, of an earlier design: no face is sensing. Name one."]


def test_whoever_waits_is_told_of_their_own_request(jobs: Jobs) -> None:
    """The first ends as the second, an equal one, is asked for: each is told of its own end."""
    design, sent, ends = SensorDesign(name="any"), [], []
    conductor: Any = jobs.conductor
    conductor.submit = lambda *words: sent.append(asked(*words[1:])) or sent[-1]
    for name in ("first", "second"):
        then = lambda event, name=name: ends.append((name, event.request))  # noqa: E731
        jobs.submit("variant", design, PressCase(), ("shoot",), then)
    for request in sent:
        jobs.pump([Finished(job="variant", request=request, error=None, seconds=1.0)])
    assert [name for name, _ in ends] == ["first", "second"]
    assert all(told is request for (_, told), request in zip(ends, sent, strict=True))


def test_nobody_is_told_of_a_request_that_was_replaced(jobs: Jobs) -> None:
    """The end of the older one, which was stopped for the newer, reaches no one."""
    design, sent, ends = SensorDesign(name="any"), [], []
    conductor: Any = jobs.conductor
    conductor.submit = lambda *words: sent.append(asked(*words[1:])) or sent[-1]
    for name in ("first", "second"):
        then = lambda event, name=name: ends.append(name)  # noqa: E731
        jobs.submit("import", design, PressCase(), ("intake",), then)
    stopped = Finished(
        job="import", request=sent[0], error=Cancelled("newer"), seconds=1.0, superseded=True
    )
    jobs.pump([stopped])
    assert ends == []
    jobs.pump([Finished(job="import", request=sent[1], error=None, seconds=1.0)])
    assert ends == ["second"]


def test_a_failed_image_preview_takes_the_one_before_away(jobs: Jobs, told: Told) -> None:
    """The designer reads one line in the log; none where the shape fails, which tells itself."""
    shown = []
    jobs.on_failed = lambda error, job: shown.append(job)
    jobs.pump([failed(IMAGE_PREVIEW)])
    assert told.lines == []
    jobs.pump([dataclasses.replace(failed(IMAGE_PREVIEW), failed="")])
    assert shown == [IMAGE_PREVIEW, IMAGE_PREVIEW]
    assert told.errors == []
    assert told.lines == ["image preview: no face is sensing. Name one."]


def test_every_stage_has_a_name_for_people() -> None:
    """The log and the bar never show the name of a function, nor one name for two stages."""
    labels = [stage.label for stage in STAGES.values()]
    assert len(set(labels)) == len(labels)
    assert all(label[0].isupper() for label in labels)
