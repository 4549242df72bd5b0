"""LEDs, lamps and cameras in the 3D view."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ui.scene.camera_body import add_camera_body
from ui.scene.lamps import LampsView
from ui.scene.ring_leds import RingLeds
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.optics import Optics

FRUSTUM_MM = 4.0
"""Size of a frustum; viser gives all of one size the same volume."""
WIDEST_DEG = 150.0
"""A fisheye is drawn at most so wide."""
USUAL_DEG = 100.0
"""Wider frusta are smaller, so that they hide no more than one of this angle."""
IMAGE_PX = 160
"""Width at most of the image in a frustum."""
LENS_COLOURS = {
    LensModel.PINHOLE: (255, 200, 0),
    LensModel.OPENCV: (255, 200, 0),
    LensModel.EQUIDISTANT: (255, 150, 0),
    LensModel.OPENCV_FISHEYE: (255, 150, 0),
}


class RigView:
    """Nodes of one ring, the lamps and the cameras."""

    def __init__(self, server: Any) -> None:
        self.server = server
        self.api = server.scene
        self.leds = RingLeds(self.api)
        self.lamps = LampsView(self.api)
        self.cameras: list[Any] = []
        self.lights_allowed = True
        """Whether the designer wants to see LEDs and lamps at all."""
        self.cameras_allowed = True
        self._shown = True
        self._optics: Optics | None = None
        """What was shown last."""

    def show_optics(self, optics: Optics) -> None:
        """Show all lights and cameras of a design."""
        if optics is self._optics:
            # Every edit of a press asks too, many a second while a hand drags.
            return
        self._optics = optics
        with self.server.atomic():
            self.leds.show_ring(optics.ring)
            self.lamps.show_lamps(optics.lamps)
            if len(self.cameras) != len(optics.all_cameras):
                # Images are told apart by the numbers of cameras, and these have moved up.
                self.forget_image()
            while len(self.cameras) > len(optics.all_cameras):
                self.cameras.pop().remove()
            for number, camera in enumerate(optics.all_cameras):
                self._show_camera(number, camera)
            self.show(self._shown)

    def _show_camera(self, number: int, camera: Camera) -> None:
        """Show a camera as a barrel with a lens, and what it sees as a frustum."""
        high, aspect, scale_mm = frustum(camera)
        colour = LENS_COLOURS[camera.lens]
        if number == len(self.cameras):
            name = "/camera" if number == 0 else f"/camera_{number + 1}"
            node = self.api.add_camera_frustum(
                name, fov=high, aspect=aspect, scale=scale_mm, color=colour
            )
            self.cameras.append(node)
            add_camera_body(self.api, name)
        node = self.cameras[number]
        node.fov = high
        node.aspect = aspect
        node.scale = scale_mm
        node.position = camera.position_mm
        node.wxyz = camera.wxyz
        node.color = colour

    def show_image(self, number: int, image: np.ndarray) -> None:
        """Show in a frustum what its camera sees, shape (H, W, 3), uint8."""
        if number < len(self.cameras):
            step = max(1, image.shape[1] // IMAGE_PX)
            self.cameras[number].image = image[::step, ::step]

    def forget_image(self) -> None:
        """Take away what the cameras of another sensor, or another list of cameras, saw."""
        for node in self.cameras:
            node.image = None

    def show(self, visible: bool) -> None:
        """Show or hide lights and cameras, as far as the designer wants to see them."""
        self._shown = visible
        self.lamps.show(visible and self.lights_allowed)
        self.leds.show(visible and self.lights_allowed)
        for node in self.cameras:
            node.visible = visible and self.cameras_allowed

    def allow(self, *, lights: bool, cameras: bool) -> None:
        """Let them be seen, or hide them whatever else is shown."""
        self.lights_allowed, self.cameras_allowed = lights, cameras
        self.show(self._shown)


def frustum(camera: Camera) -> tuple[float, float, float]:
    """Vertical angle [rad], aspect and size [mm] of a frustum that stands for a camera."""
    half = math.tan(math.radians(min(camera.fov_x_deg, WIDEST_DEG)) / 2)
    high = 2 * math.atan(half * camera.height_px / camera.width_px)
    # At equal volume the far side of a frustum is as wide as the cube root of its tangent.
    smaller = min(1.0, math.tan(math.radians(USUAL_DEG) / 2) / half) ** (1 / 3)
    return high, camera.width_px / camera.height_px, FRUSTUM_MM * smaller
