"""The preview on show is said to be outdated while another shape is built."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from ui.desk.image_preview import ImagePreviewFollower
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.live.image_preview import image_preview_call
from workbench.live.requests import IMAGE_PREVIEW, Request

SHORT = SensorDesign(name="short", family="finger", shape={"cylinder_mm": 18.0})
LONG = SensorDesign(name="long", family="finger", shape={"cylinder_mm": 22.0})


class FakeDesk:
    """A desk that hears what its panels are told."""

    def __init__(self) -> None:
        self.session = SimpleNamespace(design=SHORT, case=PressCase())
        self.told: list[tuple[str, Any]] = []
        self.rendered = False
        self.live = False
        self.jobs = SimpleNamespace(on_preview={})
        self.conductor = SimpleNamespace(ask=lambda *words: None, give_up=lambda *words: None)
        self.shown_results = SimpleNamespace(forget=lambda *words: None)

    def current(self, stage: str) -> bool:
        return self.rendered

    def tell(self, stage: str, result: Any) -> None:
        self.told.append((stage, result))

    def answer(self, design: SensorDesign) -> None:
        case = self.session.case
        call = image_preview_call(design, case)
        request = Request(design=design, case=case, wanted=call.needs, preview=call)
        self.jobs.on_preview[IMAGE_PREVIEW](f"preview of {design.name}", request)

    @property
    def of_shape(self) -> bool | None:
        """What was last said of the preview on show."""
        return next((r for stage, r in self.told[::-1] if stage == "image_preview_of_shape"), None)


@pytest.fixture
def desk() -> Any:
    """With a preview of the short finger on show."""
    desk: Any = FakeDesk()
    desk.image_preview = ImagePreviewFollower(desk)
    desk.image_preview.follow()
    desk.answer(SHORT)
    assert desk.of_shape is True
    return desk


def test_the_preview_is_of_the_shape_before_until_the_new_one_comes(desk: Any) -> None:
    """Also where one of the way comes first; the preview of the new shape takes the mark away."""
    desk.session.design = LONG
    desk.image_preview.follow()
    assert desk.of_shape is False
    desk.answer(SHORT)
    assert desk.told[-2:] == [
        ("image_preview", "preview of short"),
        ("image_preview_of_shape", False),
    ]
    desk.answer(LONG)
    assert desk.of_shape is True


def test_an_edit_taken_back_takes_the_mark_away(desk: Any) -> None:
    """Undo: the preview on show has the shape of the state again."""
    for design, of_shape in ((LONG, False), (SHORT, True)):
        desk.session.design = design
        desk.image_preview.follow()
        assert desk.of_shape is of_shape


def test_light_and_depth_do_not_change_the_shape(desk: Any) -> None:
    """Only a shape takes seconds: what comes at once needs no mark."""
    desk.session.design = SHORT.replace("optics.ring.power", 0.5)
    desk.image_preview.follow()
    assert desk.of_shape is True


def test_nothing_is_said_of_a_preview_that_images_have_replaced(desk: Any) -> None:
    """The images of a press have marks of their own."""
    desk.rendered = True
    desk.image_preview.follow()
    desk.told.clear()
    desk.rendered, desk.session.design = False, LONG
    desk.image_preview.follow()
    assert desk.told == []
