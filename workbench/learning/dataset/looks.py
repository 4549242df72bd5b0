"""Light and camera of one built sensor: those of the design, each off by what the recipe allows.

The ring is one board: radius, height and way around it are off as a whole, powers LED by LED. Lamps
are placed one by one. A longer focal length f narrows the field of view w: tan(w / 2) ~ 1 / f of a
pinhole, w ~ 1 / f of a fisheye.
"""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from workbench.core.base.frames import quaternion
from workbench.core.base.poses import rotations
from workbench.core.design.camera import WIDEST_DEG, Camera, LensModel
from workbench.core.design.lighting import Lamp, LedRing
from workbench.core.design.optics import Optics
from workbench.core.design.turning import turn_matrix
from workbench.learning.dataset.variation import Looks

LEAST_RADIUS_MM = 0.1
"""A ring stays a ring [mm]."""


def built(optics: Optics, looks: Looks, *, seed: int, number: int) -> Optics:
    """Optics of built sensor `number`, the same however many there are."""
    return assembled(optics, looks, np.random.default_rng((seed, number, 1)))


def assembled(optics: Optics, looks: Looks, rng: np.random.Generator) -> Optics:
    """Optics of a sensor that is assembled by hand, off by what a generator draws."""
    return dataclasses.replace(
        optics,
        ring=_ring(optics.ring, looks, rng),
        lamps=tuple(_lamp(lamp, looks, rng) for lamp in optics.lamps),
        camera=_camera(optics.camera, looks, rng),
    )


def _off(rng: np.random.Generator, amount: float, count: int = 1) -> list[float]:
    """Numbers drawn evenly between minus and plus an amount."""
    return rng.uniform(-amount, amount, count).round(6).tolist()


def _ring(ring: LedRing, looks: Looks, rng: np.random.Generator) -> LedRing:
    out_mm, up_mm, along_mm = _off(rng, looks.ring_mm, 3)
    radius_mm = max(LEAST_RADIUS_MM, ring.radius_mm + out_mm) if ring.radius_mm else 0.0
    around_deg = math.degrees(along_mm / radius_mm) if radius_mm else 0.0
    factors = _off(rng, looks.power_share, ring.count)
    before = ring.powers or (1.0,) * ring.count
    return dataclasses.replace(
        ring,
        radius_mm=radius_mm,
        height_mm=max(0.0, ring.height_mm + up_mm),
        phase_deg=(ring.phase_deg + around_deg + 180.0) % 360.0 - 180.0,
        powers=tuple(p * (1.0 + f) for p, f in zip(before, factors, strict=True)),
    )


def _lamp(lamp: Lamp, looks: Looks, rng: np.random.Generator) -> Lamp:
    moved_mm = _off(rng, looks.ring_mm, 3)
    x, y, z = (a + b for a, b in zip(lamp.position_mm, moved_mm, strict=True))
    (factor,) = _off(rng, looks.power_share)
    return dataclasses.replace(lamp, position_mm=(x, y, z), power=lamp.power * (1.0 + factor))


def _camera(camera: Camera, looks: Looks, rng: np.random.Generator) -> Camera:
    dx, dy, dz = _off(rng, looks.camera_mm, 3)
    x, y, z = camera.position_mm
    turn_x, turn_y, turn_z = _off(rng, looks.camera_deg, 3)
    turned = rotations(np.array(camera.wxyz)) @ turn_matrix((turn_x, turn_y, turn_z))
    w, qx, qy, qz = (float(part) for part in quaternion(turned))
    (longer,) = _off(rng, looks.focal_share)
    return dataclasses.replace(
        camera,
        # A camera in the base may be pushed up, not through the floor.
        position_mm=(x + dx, y + dy, z + (abs(dz) if z < looks.camera_mm else dz)),
        wxyz=(w, qx, qy, qz),
        fov_x_deg=_field_of_view_deg(camera, 1.0 + longer),
    )


def _field_of_view_deg(camera: Camera, focal_factor: float) -> float:
    """The field of view with a focal length that many times as long [degree]."""
    half = math.radians(camera.fov_x_deg) / 2.0
    if camera.lens in (LensModel.EQUIDISTANT, LensModel.OPENCV_FISHEYE):
        wide = half / focal_factor
    else:
        wide = math.atan(math.tan(half) / focal_factor)
    return min(WIDEST_DEG[camera.lens], 2.0 * math.degrees(wide))
