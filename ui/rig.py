"""LEDs and camera in the 3D view."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from workbench.core.camera import Camera, LensModel
from workbench.core.leds import colour_sectors, led_places
from workbench.core.lighting import LedRing
from workbench.led_colours import shown_colour

FRUSTUM_MM = 4.0
WIDEST_DEG = 150.0
"""A fisheye is drawn at most so wide."""
LENS_COLOURS = {
    LensModel.PINHOLE: (255, 200, 0),
    LensModel.OPENCV: (255, 200, 0),
    LensModel.EQUIDISTANT: (255, 150, 0),
    LensModel.OPENCV_FISHEYE: (255, 150, 0),
}


class RigView:
    """Nodes of one ring and one camera."""

    def __init__(self, server: Any) -> None:
        self.server = server
        self.api = server.scene
        self.leds: list[Any] = []
        self.camera: Any = None

    def show_lights(self, ring: LedRing) -> None:
        """Show the LEDs of a ring in their colours."""
        places, _ = led_places(ring)
        sectors = colour_sectors(ring)
        with self.server.atomic():
            while len(self.leds) > ring.count:
                self.leds.pop().remove()
            for i, place in enumerate(places):
                colour = shown_colour(ring.colours[sectors[i]])
                if i == len(self.leds):
                    led = self.api.add_icosphere(f"/leds/{i}", radius=0.7, subdivisions=2)
                    self.leds.append(led)
                self.leds[i].position = place
                self.leds[i].color = colour

    def show_camera(self, camera: Camera, image: np.ndarray | None = None) -> None:
        """Show the camera as a frustum, with what it sees where that is given."""
        across = math.radians(min(camera.fov_x_deg, WIDEST_DEG))
        high = 2 * math.atan(math.tan(across / 2) * camera.height_px / camera.width_px)
        aspect = camera.width_px / camera.height_px
        colour = LENS_COLOURS[camera.lens]
        if self.camera is None:
            self.camera = self.api.add_camera_frustum(
                "/camera", fov=high, aspect=aspect, scale=FRUSTUM_MM, color=colour
            )
        with self.server.atomic():
            self.camera.fov = high
            self.camera.aspect = aspect
            self.camera.position = camera.position_mm
            self.camera.wxyz = camera.wxyz
            self.camera.color = colour
            if image is not None:
                self.camera.image = image

    def forget_image(self) -> None:
        """Take away what the camera of another sensor saw."""
        if self.camera is not None:
            self.camera.image = None

    def show(self, visible: bool) -> None:
        """Show or hide LEDs and camera."""
        for node in (self.camera, *self.leds):
            if node is not None:
                node.visible = visible
