"""Cameras in the 3D view, on a page without a browser."""

from __future__ import annotations

import contextlib
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from ui.scene.rig import RigView
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing
from workbench.core.design.optics import Optics
from workbench.edit.led_colours import colour_letter


def node(*_: Any, **values: Any) -> SimpleNamespace:
    """A node of the scene."""
    return SimpleNamespace(image=None, text="", remove=lambda: None, **values)


def test_frusta_forget_images_when_cameras_come_or_go() -> None:
    """Of cameras 1, 2, 3 the second goes: the third is number 2, whose image was another's."""
    names = ("add_icosphere", "add_camera_frustum", "add_label", "add_mesh_simple")
    api = SimpleNamespace(**dict.fromkeys(names, node))
    rig = RigView(SimpleNamespace(scene=api, atomic=contextlib.nullcontext))
    further = (Camera(fov_x_deg=60.0), Camera(fov_x_deg=70.0))
    three = Optics(ring=LedRing(count=1), cameras=further)
    rig.show_optics(three)
    for number in range(3):
        rig.show_image(number, np.full((4, 4, 3), number, dtype=np.uint8))
    rig.show_optics(three)
    assert [camera.image is not None for camera in rig.cameras] == [True] * 3
    rig.show_optics(Optics(ring=LedRing(count=1), cameras=further[1:]))
    assert [camera.image for camera in rig.cameras] == [None] * 2


@pytest.mark.parametrize(
    ("colour", "letter"),
    [
        ("#ff0000", "R"),
        ("#00ff00", "G"),
        ("460nm", "B"),
        ("525nm/35nm", "G"),
        ("#ffee00", "Y"),
        ("#00ffff", "C"),
        ("#ff20d0", "M"),
        ("5600K", "W"),
    ],
)
def test_each_light_has_the_letter_of_its_colour(colour: str, letter: str) -> None:
    """Hue is not the only carrier."""
    assert colour_letter(colour) == letter
