"""The pressed skin: frames are made in the background, a replaced one goes a moment later."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from tests.unit.test_quantities import SQUARE, contact
from ui.page.background_thread import BackgroundThread
from ui.scene.pressed import CUT_LINGER_S, LINGER_S, PressedView
from workbench.core.result.sensing import Contact
from workbench.view.quantities import Quantity


class Node:
    """A mesh of the page, which viser refuses to remove twice."""

    def __init__(self, name: str, visible: bool) -> None:
        self.name = name
        self.visible = visible
        self.here = True

    def on_click(self, handler: Any = None, *, modifier: str | None = None) -> Any:
        return (lambda act: act) if handler is None else handler

    def remove(self) -> None:
        assert self.here, "removed twice"
        self.here = False


class Scene:
    """Takes meshes and arrows; time is moved by hand."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.nodes: list[Node] = []

    def add_glb(self, name: str, glb: bytes, *, visible: bool) -> Node:
        self.nodes.append(Node(name, visible))
        return self.nodes[-1]

    def clock(self) -> float:
        return self.now_s

    @property
    def here(self) -> list[bool]:
        return [node.here for node in self.nodes]


@pytest.fixture
def scene() -> Scene:
    return Scene()


@pytest.fixture
def background() -> BackgroundThread:
    def fail(error: Exception) -> None:
        raise error

    return BackgroundThread(fail)


@pytest.fixture
def view(scene: Scene, background: BackgroundThread) -> PressedView:
    return PressedView(scene, lambda event: None, background, scene.clock)


def pump(view: PressedView, until: Callable[[], bool]) -> None:
    """Turn as the desk's pump does, until something holds."""
    deadline = time.monotonic() + 10.0
    while not until():
        assert time.monotonic() < deadline, "it does not come"
        view.background.turn()
        view.turn()
        time.sleep(0.005)


def test_a_replaced_live_frame_lingers_and_goes(scene: Scene, view: PressedView) -> None:
    """Frames at 0 s and 0.5 s: the first goes 0.6 s after it was replaced, the second stays."""
    view.load_live(SQUARE, contact())
    scene.now_s = 0.5
    view.load_live(SQUARE, contact(displacement_mm=np.zeros((1, 4, 3), np.float32)))
    scene.now_s = 0.49 + LINGER_S
    view.turn()
    assert scene.here == [True, True]
    scene.now_s = 0.5 + LINGER_S
    view.turn()
    view.turn()
    assert scene.here == [False, True]


def test_frames_are_removed_once_however_they_go(scene: Scene, view: PressedView) -> None:
    """Cleared before their time: all go at once, and the pump finds none left."""
    for _ in range(3):
        view.load_live(SQUARE, contact())
    view.clear()
    assert scene.here == [False, False, False]
    scene.now_s = 10.0
    view.turn()


def long_press(frames: int) -> Contact:
    """A press of so many frames."""
    way = np.zeros((frames, 4, 3), np.float32)
    way[:, 0, 2] = -np.linspace(0.1, 1.0, frames)
    return contact(displacement_mm=way, reaction_N=np.zeros((frames, 3)))


def test_a_press_shows_once_it_has_been_measured(scene: Scene, view: PressedView) -> None:
    """Frame 3 of 5 is asked for at once; it is there after a while, then the others, hidden."""
    told: list[bool] = []
    view.on_painted = lambda: told.append(view.drawn)
    view.load(SQUARE, long_press(5))
    view.show(3)
    assert not view.drawn and not scene.nodes and view.shown is None
    pump(view, lambda: len(scene.nodes) == 5)
    assert told == [True]
    assert [node.name for node in scene.nodes if node.visible] == [view.name_of(3)]
    assert {node.name.rpartition("/")[2] for node in scene.nodes} == {"1", "2", "3", "4", "5"}


def test_a_press_that_was_replaced_never_shows(scene: Scene, view: PressedView) -> None:
    """Of two presses that come at once only the second is drawn, however late the first is."""
    for frames in (5, 2):
        view.load(SQUARE, long_press(frames))
        view.show(1)
    pump(view, lambda: len(scene.nodes) == 2)
    for _ in range(20):
        view.background.turn()
        time.sleep(0.005)
    assert len(scene.nodes) == 2


def test_colours_change_in_place(scene: Scene, view: PressedView) -> None:
    """The old colours stay until the new ones are drawn, and go soon after."""
    view.load(SQUARE, long_press(2))
    view.show(2)
    pump(view, lambda: len(scene.nodes) == 2)
    view.paint(Quantity.PRESSURE)
    assert scene.here == [True, True]
    pump(view, lambda: view.shown is not None and view.shown.quantity is Quantity.PRESSURE)
    seen = [node for node in scene.nodes if node.visible and node.here]
    assert len(seen) == 2, "the old frame and the new one"
    scene.now_s += CUT_LINGER_S
    pump(view, lambda: sum(node.visible and node.here for node in scene.nodes) == 1)
