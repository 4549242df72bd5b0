"""LEDs, lamps and cameras of another design in the 3D view: a few nodes, whatever their number.

Lights are one cloud of round points in their colours, a lamp at its middle; cameras are frusta in
the colour of the ghost, without images.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ui.scene.rig import frustum
from workbench.core.design.leds import colour_sectors, led_places
from workbench.core.design.optics import Optics
from workbench.edit.led_colours import shown_colour

LIGHT_MM = 1.2
"""Size of a point that stands for a light."""


def ghost_rig(
    api: Any, name: str, optics: Optics, offset_mm: np.ndarray, colour: tuple[int, int, int]
) -> list[Any]:
    """Draw lights and cameras of a design moved by `offset_mm`, shape (3,); returns the nodes."""
    places, colours = lights(optics)
    nodes = []
    if len(places):
        moved = (places + offset_mm).astype(np.float32)
        look = {"point_size": LIGHT_MM, "point_shape": "circle"}
        nodes.append(api.add_point_cloud(f"{name}/lights", moved, colours, **look))
    for number, camera in enumerate(optics.all_cameras):
        high, aspect, scale_mm = frustum(camera)
        nodes.append(
            api.add_camera_frustum(
                f"{name}/camera_{number}",
                fov=high,
                aspect=aspect,
                scale=scale_mm,
                color=colour,
                wxyz=camera.wxyz,
                position=np.asarray(camera.position_mm) + offset_mm,
            )
        )
    return nodes


def lights(optics: Optics) -> tuple[np.ndarray, np.ndarray]:
    """Places [mm] of LEDs and lamps, shape (L, 3), and their colours, shape (L, 3), uint8."""
    ring = optics.ring
    places = [*led_places(ring)[0], *(lamp.position_mm for lamp in optics.lamps)]
    colours = [shown_colour(ring.colours[sector]) for sector in colour_sectors(ring)]
    colours += [shown_colour(lamp.colour) for lamp in optics.lamps]
    return (
        np.asarray(places, dtype=np.float64).reshape(-1, 3),
        np.asarray(colours, dtype=np.uint8).reshape(-1, 3),
    )
