"""The pressed skin follows a live press: a replaced frame stays a moment, then goes, once."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from tests.unit.test_quantities import SQUARE, contact
from ui.pressed import LINGER_S, PressedView


class Node:
    """A mesh of the page, which viser refuses to remove twice."""

    def __init__(self, visible: bool) -> None:
        self.visible = visible
        self.here = True

    def on_click(self, handler: Any) -> None:
        pass

    def remove(self) -> None:
        assert self.here, "removed twice"
        self.here = False


class Scene:
    """Takes meshes and arrows; time is moved by hand."""

    def __init__(self) -> None:
        self.now_s = 0.0
        self.nodes: list[Node] = []

    def add_glb(self, name: str, glb: bytes, *, visible: bool) -> Node:
        self.nodes.append(Node(visible))
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
def view(scene: Scene) -> PressedView:
    return PressedView(scene, lambda event: None, scene.clock)


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
