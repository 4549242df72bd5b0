"""One camera with its light, and one photograph of the untouched sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.raster.display import light_of
from sim.optics.studio.render import Studio
from sim.optics.studio.unit_residual import UnitResidual, places, slopes
from sim.reading.rest_skin import RestSkin, open_rest_skin
from sim.reading.sight import Sight, at_rest
from sim.reading.tilt_light import TiltLight, tilt_light
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.camera import Camera, ImageSensor

DARK, BRIGHT = 0.02, 0.98
"""Display light between which the gain is found."""
ALIKE = 0.02
"""Blur of the light of the photograph over that of the design, over the width of the image."""
HELD = 0.02
"""Weight of its median where neither can be told, over that of pixels all around."""
FARTHEST = 2.0
"""By which that of a place is another one, at most: beyond that something else is seen."""


@dataclass(frozen=True, kw_only=True)
class Untouched:
    """What all readings of one sensor share; N pixels."""

    studio: Studio
    camera: Camera
    skin: RestSkin
    light: TiltLight
    sight: Sight
    """What the pixels see."""
    sees: np.ndarray
    """Pixels that see the skin, shape (N,), bool."""
    through: np.ndarray
    """Share of light that passes the cavity's wall at each pixel, shape (N,)."""
    idle: np.ndarray
    """The photograph [grey], shape (H, W, 3)."""
    idle_light: np.ndarray
    """Its display light, shape (N, 3)."""
    exposure: np.ndarray
    """Display light of the photograph per radiance, shape (N, 3)."""
    gain: float
    """Light of the photograph over that of the design, of most pixels."""
    light_error: float
    """By how much it is another one from place to place and colour to colour: the standard
    deviation of its logarithm over pixels that see skin [1]."""
    unit: UnitResidual | None = None
    """What the built sensor shows beyond its design's light."""

    @property
    def sensor(self) -> ImageSensor:
        """Curve of the image sensor."""
        return self.camera.sensor

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.studio.imager.shape

    def unit_change(self, pixels: np.ndarray, normal: np.ndarray, rest: np.ndarray) -> np.ndarray:
        """Grey levels that the unit adds, shape (P, 3), 0 without one.

        Args:
            pixels: Numbers, shape (P,).
            normal: Unit normals into the sensor that they see, shape (P, 3).
            rest: Those at rest, shape (P, 3).
        """
        if self.unit is None:
            return np.zeros((len(pixels), 3))
        rows, columns = self.shape
        slope = slopes(normal, rest, self.camera)
        return self.unit.change(slope, places(pixels, columns, rows))


def open_untouched(
    studio: Studio,
    camera: Camera,
    idle: np.ndarray,
    *,
    light: TiltLight | None = None,
    unit: UnitResidual | None = None,
    monitor: Monitor = silent,
) -> Untouched:
    """Prepare.

    Args:
        studio: The camera and its light.
        camera: The same.
        idle: Photograph of the untouched sensor [grey], shape (H, W, 3).
        light: Light by tilt where it is known; else the shading is asked, which takes seconds.
        unit: What the built sensor shows beyond its design's light.
        monitor: Progress and cancellation.
    """
    view = studio.imager.raster.view
    skin = open_rest_skin(view)
    found = light or tilt_light(skin, studio.shade_tilted, monitor=monitor)
    sight = at_rest(studio)
    through = view.transmittance.astype(np.float64)
    sees = (sight.face >= 0) & (through > 0.0)
    exposure = studio.exposure.reshape(-1, 3).astype(np.float64)
    idle_light = light_of(idle.astype(np.float64).reshape(-1, 3) / 255.0, camera.sensor)
    over = _over(idle_light, sight.light * exposure, sees, studio.imager.shape)
    gain = float(np.median(over[sees])) if sees.any() else 1.0
    error = np.log(over[sees] / gain)
    return Untouched(
        studio=studio,
        camera=camera,
        skin=skin,
        light=found,
        sight=sight,
        sees=sees,
        through=through,
        idle=idle.astype(np.float64),
        idle_light=idle_light,
        exposure=over * exposure,
        gain=gain,
        light_error=float(np.sqrt((error**2).mean())) if sees.any() else 0.0,
        unit=unit,
    )


def _over(
    photographed: np.ndarray, own: np.ndarray, sees: np.ndarray, shape: tuple[int, int]
) -> np.ndarray:
    """Light of a photograph over that of the design around each pixel, shape (N, 3).

    Args:
        photographed: Display light, shape (N, 3).
        own: The same of the design.
        sees: Pixels that see skin, shape (N,), bool.
        shape: Rows and columns.
    """
    import cv2

    plain = sees & (own.min(axis=1) > DARK) & (own.max(axis=1) < BRIGHT)
    plain &= photographed.max(axis=1) < BRIGHT
    if not plain.any():
        return np.ones_like(photographed)
    most = np.median(photographed[plain] / own[plain])

    def around(light: np.ndarray) -> np.ndarray:
        image = (plain[:, None] * light).reshape(*shape, 3).astype(np.float32)
        return cv2.GaussianBlur(image, (0, 0), ALIKE * shape[1]).reshape(-1, 3)

    held = HELD * own[plain].mean(axis=0)
    found = (around(photographed) + most * held) / (around(own) + held)
    return np.clip(found, most / FARTHEST, most * FARTHEST).astype(np.float64)
