"""What a tilt or a dent of the skin changes in the image, beside the noise of a pixel.

J = dI / d(tilt) [grey / degree], shape (3 colours, 2 tilts), by central differences of the shading.
Normal resolvability is the smallest singular value of J with each row over the noise of its
colour: by how many standard deviations a tilt of one degree in the least visible direction moves
the pixel. Sensitivity is the mean change over the contact of a ball of 6 mm: in a shallow dent of
depth d the contact radius is a = sqrt(R d) and the mean slope 2 a / (3 R), and the mean of
|J_c t| over directions t is 2 / pi |J_c|, averaged over the colours. Shadows and the rim of the
dent are left out; `validate optics` compares it with rendered dents.

The depth at a force F is that of a ball on a bonded layer of the wall's thickness h:
F = 16/9 E sqrt(R) d^1.5 (1 + 1.133 chi + 1.283 chi^2 + 0.769 chi^3 + 0.0975 chi^4),
chi = sqrt(R d) / h. Source: Dimitriadis and others, Biophys. J. 82 (2002) 2798, eq. 12, for an
incompressible layer; silicone skins come within some 10 % of it.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim.optics.raster.display import shown
from workbench.core.design.camera import ImageSensor

TILT_DEG = 2.0
BALL_RADIUS_MM = 3.0
DENT_MM = 0.1
FORCE_N = 0.1
QUANTISATION_GREY = 1.0 / np.sqrt(12.0)
"""Standard deviation of rounding to whole grey levels."""
HALVINGS = 30


def grey(linear: np.ndarray, sensor: ImageSensor) -> np.ndarray:
    """Grey level in [0, 255], not rounded, of display light of any shape."""
    return 255.0 * shown(linear, sensor)


def tilt_jacobian(
    shade: Callable[[np.ndarray], np.ndarray], inward: np.ndarray, sensor: ImageSensor
) -> np.ndarray:
    """Grey levels per degree of tilt about two tangents, shape (V, 3, 2), float32.

    Args:
        shade: Display light, shape (V, 3), of the skin if its inward normals were (V, 3).
        inward: Unit normals into the sensor, shape (V, 3).
        sensor: Its curve.
    """
    one, two = tangents(inward)
    step = np.radians(TILT_DEG)
    columns = []
    for tangent in (one, two):
        forth, back = (
            grey(shade(np.cos(step) * inward + sign * np.sin(step) * tangent), sensor)
            for sign in (1.0, -1.0)
        )
        columns.append((forth - back) / (2.0 * TILT_DEG))
    return np.stack(columns, axis=-1).astype(np.float32)


def tangents(normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across each unit normal, shape (V, 3) each."""
    flat = np.abs(normals[:, 2]) < 0.9
    helper = np.where(flat[:, None], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0])
    one = np.cross(helper, normals)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    return one, np.cross(normals, one)


def noise_grey(linear: np.ndarray, sensor: ImageSensor) -> np.ndarray:
    """Standard deviation of a pixel [grey level] at display light (V, 3), rounding included.

    Shot noise sqrt(S) and read noise in electrons, through the slope of the display curve.
    """
    if not sensor.noise:
        return np.full(linear.shape, QUANTISATION_GREY)
    light = np.clip(linear, 0.0, 1.0)
    gain = 10.0 ** (sensor.gain_dB / 20.0)
    electrons = light * sensor.full_well_e / gain
    spread = np.sqrt(electrons + sensor.read_noise_e**2) * gain / sensor.full_well_e
    low, high = np.clip(light - spread, 0.0, 1.0), np.clip(light + spread, 0.0, 1.0)
    slope = (grey(high, sensor) - grey(low, sensor)) / np.maximum(high - low, 1e-12)
    return np.hypot(slope * spread, QUANTISATION_GREY)


def resolvability(jacobian: np.ndarray, noise: np.ndarray) -> np.ndarray:
    """Smallest singular value of J over noise [1/degree], shape (V,), float32.

    In closed form of the 2 x 2 matrix J^T J = ((a, b), (b, c)):
    s^2 = (a + c) / 2 - sqrt(((a - c) / 2)^2 + b^2).
    """
    scaled = jacobian / noise[:, :, None]
    a = np.einsum("vc,vc->v", scaled[:, :, 0], scaled[:, :, 0])
    b = np.einsum("vc,vc->v", scaled[:, :, 0], scaled[:, :, 1])
    c = np.einsum("vc,vc->v", scaled[:, :, 1], scaled[:, :, 1])
    least = (a + c) / 2.0 - np.hypot((a - c) / 2.0, b)
    return np.sqrt(np.maximum(least, 0.0)).astype(np.float32)


def dent_slope_deg(depth_mm: np.ndarray | float) -> np.ndarray:
    """Mean slope of the skin under a ball [degree] at a depth [mm] of any shape."""
    radius = np.sqrt(BALL_RADIUS_MM * np.asarray(depth_mm))
    return np.degrees(2.0 * radius / (3.0 * BALL_RADIUS_MM))


def sensitivity_grey(jacobian: np.ndarray, slope_deg: np.ndarray | float) -> np.ndarray:
    """Mean change over the contact and the colours [grey level], shape (V,), float32."""
    size = np.linalg.norm(jacobian, axis=2).mean(axis=1)
    return (2.0 / np.pi * size * slope_deg).astype(np.float32)


def depth_at_force_mm(force_N: float, young_MPa: float, thickness_mm: np.ndarray) -> np.ndarray:
    """Depth [mm] of a ball at a force on layers of thicknesses [mm], shape (V,), by bisection."""
    low, high = np.zeros_like(thickness_mm), np.full_like(thickness_mm, 2.0 * BALL_RADIUS_MM)
    for _ in range(HALVINGS):
        middle = (low + high) / 2.0
        chi = np.sqrt(BALL_RADIUS_MM * middle) / np.maximum(thickness_mm, 1e-3)
        series = 1.0 + chi * (1.133 + chi * (1.283 + chi * (0.769 + chi * 0.0975)))
        force = 16.0 / 9.0 * young_MPa * np.sqrt(BALL_RADIUS_MM) * middle**1.5 * series
        low, high = np.where(force < force_N, middle, low), np.where(force < force_N, high, middle)
    return (low + high) / 2.0
