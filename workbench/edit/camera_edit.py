"""How a designer handles a camera: by three angles and by the names of lenses.

The axis of a camera that is tilted by t toward the azimuth p (pan) points to
(sin t cos p, sin t sin p, cos t); then the camera is rolled by r about it:

    R = Rz(p) Ry(t) Rz(-p) Rz(r)

so that without tilt the pan means nothing and the roll turns the image. Angles in degree.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from workbench.core.base.frames import quaternion
from workbench.core.base.poses import rotations
from workbench.core.base.units import radians
from workbench.core.design.camera import Camera, LensModel
from workbench.core.design.lighting import Vector

LENSES = {
    "60": (60.0, LensModel.PINHOLE),
    "90": (90.0, LensModel.PINHOLE),
    "120": (120.0, LensModel.EQUIDISTANT),
    "160": (160.0, LensModel.EQUIDISTANT),
}
"""Field of view [degree] and model of lenses that sensors of this size have; our choice."""
UPRIGHT = 1e-6
"""Sine of a tilt below which a camera has no azimuth."""
ADDED_TILT_DEG = 20.0
"""By how much a further camera is tilted from the one that it begins as."""


def with_lens(camera: Camera, name: str) -> Camera:
    """A camera with a lens of `LENSES`, without distortion."""
    fov_x_deg, lens = LENSES[name]
    return dataclasses.replace(camera, fov_x_deg=fov_x_deg, lens=lens, distortion=())


def wxyz_of(angles_deg: Vector) -> tuple[float, float, float, float]:
    """Unit quaternion of tilt, pan and roll [degree]."""
    tilt, pan, roll = (radians(angle) for angle in angles_deg)
    rotation = _about_z(pan) @ _about_y(tilt) @ _about_z(roll - pan)
    w, x, y, z = (round(float(part), 12) + 0.0 for part in quaternion(rotation))
    return w, x, y, z


def angles_of(wxyz: tuple[float, float, float, float]) -> Vector:
    """Tilt, pan and roll [degree] of a unit quaternion; the pan is 0 where there is no tilt."""
    rotation = _matrix(wxyz)
    x, y, z = rotation[:, 2]
    tilt = math.atan2(math.hypot(x, y), z)
    pan = math.atan2(y, x) if math.hypot(x, y) > UPRIGHT else 0.0
    rest = _about_y(-tilt) @ _about_z(-pan) @ rotation
    roll = math.atan2(rest[1, 0], rest[0, 0]) + pan
    turned = (math.degrees(roll) + 180.0) % 360.0 - 180.0
    found = (math.degrees(tilt), math.degrees(pan), turned)
    tilt_deg, pan_deg, roll_deg = (round(angle, 4) + 0.0 for angle in found)
    return tilt_deg, pan_deg, roll_deg


def further_camera(camera: Camera) -> Camera:
    """A camera to begin with, beside the one it is like: tilted, to see something else."""
    tilt_deg, pan_deg, roll_deg = angles_of(camera.wxyz)
    turned = wxyz_of((tilt_deg + ADDED_TILT_DEG, pan_deg, roll_deg))
    return dataclasses.replace(camera, wxyz=turned)


def _about_z(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def _about_y(angle: float) -> np.ndarray:
    c, s = math.cos(angle), math.sin(angle)
    return np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])


def _matrix(wxyz: tuple[float, float, float, float]) -> np.ndarray:
    return rotations(np.asarray(wxyz) / math.hypot(*wxyz))
