"""The object in the 3D view: its shape comes of a lane, and the old one stays until it is there."""

from __future__ import annotations

import contextlib
import dataclasses
import pickle
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import workbench.live.indenter_display as display
from ui.desk.object_follower import ObjectFollower
from ui.scene.object_view import ObjectView
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody
from workbench.live.object_drawing import Drawing, DrawingCall, shapes_of
from workbench.live.requests import DRAWN, FOLLOWING, Request
from workbench.pipeline.store import Store
from workbench.project.aim import SkinPlace

CROSS = Indenter(kind=IndenterKind.CROSS)


def tetrahedron(lowest_mm: float) -> Drawing:
    """Something to draw."""
    points = np.array([[0.0, 0, -lowest_mm], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], np.uint32)
    return Drawing(points_mm=points, faces=faces, lowest_mm=lowest_mm)


def object_view() -> ObjectView:
    """The view of a server that only remembers, above a flat skin at z = 10."""

    def add(name: str, vertices: np.ndarray, faces: np.ndarray, **words: Any) -> SimpleNamespace:
        return SimpleNamespace(**{"vertices": vertices, "faces": faces, "opacity": None, **words})

    server = SimpleNamespace(
        scene=SimpleNamespace(add_mesh_simple=add), atomic=contextlib.nullcontext
    )
    flat = SkinPlace(np.array([0.0, 0.0, 10.0]), 0.0, 0, np.array([0.0, 0.0, 1.0]))
    body: Any = SimpleNamespace(place_near=lambda target_mm: flat)
    return ObjectView(server, body)


class FakeDesk:
    """A desk whose lane remembers what it was asked."""

    def __init__(self) -> None:
        self.session = SimpleNamespace(design=SensorDesign(name="any"), case=PressCase())
        self.asked: list[DrawingCall] = []
        self.jobs = SimpleNamespace(on_preview={})
        self.conductor = SimpleNamespace(ask=lambda job, d, c, call: self.asked.append(call))
        shown = object_view()
        self.scene = SimpleNamespace(object=shown, body=shown.body)
        self.object_drawn = lambda: None
        self.told: list[str] = []

    def tell(self, stage: str, result: Any) -> None:
        self.told.append(stage)

    def take(self, indenter: Indenter) -> None:
        self.session.case = dataclasses.replace(self.session.case, indenter=indenter)

    def answer(self, indenter: Indenter, drawing: Drawing) -> None:
        case = PressCase(indenter=indenter)
        request = Request(design=self.session.design, case=case, wanted=())
        self.jobs.on_preview[DRAWN](drawing, request)


def test_the_desk_computes_no_shape_and_keeps_the_old_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """A cross takes a second: it is asked for once, and what was drawn stays until it is there."""

    def held_up(indenter: Indenter) -> None:
        raise AssertionError("contoured in the process that serves all tabs")

    monkeypatch.setattr(display, "display_mesh", held_up)
    desk: Any = FakeDesk()
    follower = ObjectFollower(desk)
    desk.answer(desk.session.case.indenter, tetrahedron(2.0))
    before = desk.scene.object.node.vertices
    desk.take(CROSS)
    for _ in range(3):
        follower.follow()
    assert desk.asked == [DrawingCall(indenter=CROSS)]
    assert desk.scene.object.node.vertices is before
    desk.answer(CROSS, tetrahedron(3.0))
    assert desk.scene.object.node.vertices[0, 2] == -3.0
    assert desk.scene.object.standing[2] == pytest.approx(13.0)


def test_it_is_asked_for_before_there_is_a_body_and_drawn_on_it() -> None:
    """At the first start the shape comes before the body: nothing is drawn in the air."""
    desk: Any = FakeDesk()
    body = desk.scene.body
    place_near, body.place_near = body.place_near, lambda target_mm: None
    follower = ObjectFollower(desk)
    follower.follow()
    assert len(desk.asked) == 1
    desk.answer(desk.session.case.indenter, tetrahedron(2.0))
    assert desk.scene.object.node is None
    body.place_near = place_near
    desk.scene.object.place(Press())
    follower.follow()
    assert len(desk.asked) == 1
    drawn: Any = desk.scene.object.node
    assert drawn.position[2] == pytest.approx(12.0)


def test_the_last_choice_wins_but_a_slider_shows_what_is_made_on_the_way() -> None:
    """A cross that comes after a cube was chosen is not drawn; a smaller cube is."""
    desk: Any = FakeDesk()
    ObjectFollower(desk)
    cube = Indenter(kind=IndenterKind.CUBE, size_mm=5.0)
    desk.take(cube)
    desk.answer(CROSS, tetrahedron(3.0))
    assert desk.scene.object.node is None
    desk.answer(dataclasses.replace(cube, size_mm=4.0), tetrahedron(2.0))
    assert desk.scene.object.standing[2] == pytest.approx(12.0)


def test_a_shape_that_comes_late_takes_the_place_of_the_frame_on_show() -> None:
    """A stored press may be shown before its object is: it must not jump back onto the skin."""
    view = object_view()
    pose = np.array([1.0, 2.0, 9.5, 1.0, 0.0, 0.0, 0.0])
    contact: Any = SimpleNamespace(indenter_pose=pose[None], object_mm=np.zeros(0))
    view.press(contact, 0)
    view.show(tetrahedron(2.0), Press())
    assert view.node.position == tuple(pose[:3])
    view.place(Press())
    assert view.standing[2] == pytest.approx(12.0)


def test_a_lane_makes_each_shape_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Back to an object, or only softer: nothing is contoured anew; the call can be sent."""
    made: list[Indenter] = []

    def counted(indenter: Indenter) -> tuple[np.ndarray, np.ndarray]:
        made.append(indenter)
        return np.eye(3), np.array([[0, 1, 2]], np.int32)

    monkeypatch.setattr(display, "display_mesh", counted)
    kept: dict[str, Any] = {}
    soft = dataclasses.replace(CROSS, soft=SoftBody())
    for indenter in (CROSS, Indenter(), soft, CROSS):
        call = pickle.loads(pickle.dumps(DrawingCall(indenter=indenter)))
        assert call.answer(Store(tmp_path), kept, silent).lowest_mm == 0.0
    shapes_of(kept).shape(CROSS)
    assert made == [CROSS, Indenter()]


def test_a_drawing_never_shows_a_bar_or_a_line_in_the_log() -> None:
    """It follows the hand."""
    assert DRAWN in FOLLOWING
    assert DrawingCall(indenter=CROSS).lane == "look"
