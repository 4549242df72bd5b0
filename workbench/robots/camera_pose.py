"""A design's camera in the conventions of others: OpenGL's axes, a vertical field of view."""

from __future__ import annotations

import numpy as np

from sim.optics.camera.camera import pixel_directions, rotation_camera_to_sensor
from workbench.core.design.camera import Camera

WIDEST_DEG = 170.0
"""Vertical field beyond which no program draws in perspective."""


def opengl_wxyz(camera: Camera) -> tuple[float, float, float, float]:
    """Quaternion of a camera that looks along its -Z with +Y up, as MuJoCo's do.

    Ours looks along +Z with +Y down: half a turn about X, q (0, 1, 0, 0).
    """
    w, x, y, z = camera.wxyz
    return (-x, w, z, -y)


def field_y_deg(camera: Camera) -> float:
    """Angle between the lines of sight through the middle of the upper and of the lower edge.

    Of a pinhole it is the vertical field of view. Other lenses have no equal in programs that draw
    in perspective; theirs is kept to 170 degrees.
    """
    middle = 0.5 * camera.width_px
    ends = np.array([[middle, 0.0], [middle, float(camera.height_px)]])
    # Each from the optical axis: together they may be more than 180 degrees.
    along = pixel_directions(camera, ends) @ rotation_camera_to_sensor(camera)[:, 2]
    return min(float(np.degrees(np.arccos(along)).sum()), WIDEST_DEG)
