"""What will be refused is asked once the hand rests, after all that the hand waits for."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from ui.desk.foresight import REST_S, Foresight
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.live.requests import FORESIGHT, IMAGE_PREVIEW, Request

SHORT = SensorDesign(name="short", family="finger", shape={"cylinder_mm": 18.0})
LONG = SensorDesign(name="long", family="finger", shape={"cylinder_mm": 22.0})


class FakeDesk:
    """A desk whose conductor notes what it is asked."""

    def __init__(self) -> None:
        self.session = SimpleNamespace(design=SHORT, case=PressCase())
        self.now_s = 0.0
        self.asked: list[Request] = []
        self.works: set[str] = set()
        self.on_turn: list[Any] = []
        self.jobs = SimpleNamespace(on_preview={})
        self.conductor = SimpleNamespace(ask=self._ask, works_on=lambda job: job in self.works)
        self.fields = SimpleNamespace(in_words=lambda text, at: text)
        self.guarded = lambda handler: handler
        widget = SimpleNamespace(visible=False, content="", on_click=lambda handler: None)
        self.header = SimpleNamespace(misfit=widget, fit=SimpleNamespace(**vars(widget)))

    def _ask(self, job: str, design: SensorDesign, case: PressCase, call: Any) -> None:
        self.asked.append(Request(design=design, case=case, wanted=(), preview=call))

    def turn(self, seconds: float) -> None:
        self.now_s += seconds
        for turn in self.on_turn:
            turn()


@pytest.fixture
def desk() -> Any:
    """At a state that has been followed."""
    desk: Any = FakeDesk()
    desk.foresight = Foresight(desk, clock=lambda: desk.now_s)
    desk.foresight.follow()
    return desk


def answer(desk: Any, found: tuple[Any, ...] = ()) -> None:
    desk.jobs.on_preview[FORESIGHT](found, desk.asked[-1])


def refusal() -> Any:
    return SimpleNamespace(message="LED 1 is outside", hint="make the ring smaller", at="optics")


def test_a_hand_that_moves_is_not_asked_for(desk: Any) -> None:
    """Once at rest it is asked once, and not while a preview of the image is made."""
    for length_mm in (19.0, 20.0, 21.0):
        desk.session.design = SHORT.replace("shape.cylinder_mm", length_mm)
        desk.foresight.follow()
        desk.turn(0.9 * REST_S)
    assert not desk.asked
    desk.works = {IMAGE_PREVIEW}
    desk.turn(REST_S)
    assert not desk.asked
    desk.works = set()
    desk.turn(0.0)
    desk.turn(REST_S)
    assert [request.design.shape["cylinder_mm"] for request in desk.asked] == [21.0]


def test_an_answer_of_another_state_is_not_shown(desk: Any) -> None:
    """Nor is it lost: the state that comes back is asked about again."""
    desk.turn(REST_S)
    desk.session.design = LONG
    desk.foresight.follow()
    answer(desk, (refusal(),))
    assert not desk.header.misfit.visible
    desk.session.design = SHORT
    desk.foresight.follow()
    desk.turn(REST_S)
    assert len(desk.asked) == 2
    answer(desk, (refusal(),))
    assert desk.header.misfit.visible and "LED 1 is outside" in desk.header.misfit.content
