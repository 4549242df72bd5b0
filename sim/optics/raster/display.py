"""Light to grey levels and back: the curve of an image sensor, and one exposure per design.

The curve is that of sRGB (IEC 61966-2-1) unless the sensor has a gamma or a measured response.
"""

from __future__ import annotations

import functools

import numpy as np

from workbench.core.design.camera import ImageSensor

BRIGHT_DISPLAY = 0.8
"""Display value in [0, 1] that the bright end of the background is exposed to."""
BRIGHT_PERCENTILE = 99.0
"""Share of pixels below that bright end [%]; the rest may saturate, as highlights do."""
LUT_STEPS = 65536
"""Entries of the encoding table: the darkest grey step then spans 20 of them."""


def srgb_encode(linear: np.ndarray) -> np.ndarray:
    """Display value in [0, 1] of linear light in [0, 1]."""
    bent = 1.055 * np.maximum(linear, 0.0031308) ** (1.0 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, 12.92 * linear, bent)


def srgb_decode(display: np.ndarray) -> np.ndarray:
    """Linear light in [0, 1] of a display value in [0, 1]."""
    bent = ((np.maximum(display, 0.04045) + 0.055) / 1.055) ** 2.4
    return np.where(display <= 0.04045, display / 12.92, bent)


def shown(light: np.ndarray, sensor: ImageSensor) -> np.ndarray:
    """Display value in [0, 1] of display light of any shape, by the sensor's curve."""
    light = np.clip(light, 0.0, 1.0)
    if sensor.response:
        return np.interp(light, np.linspace(0.0, 1.0, len(sensor.response)), sensor.response)
    return srgb_encode(light) if sensor.gamma == 0.0 else light ** (1.0 / sensor.gamma)


def light_of(display: np.ndarray, sensor: ImageSensor) -> np.ndarray:
    """Display light in [0, 1] of a display value of any shape: the inverse of `shown`.

    Values that a measured response never gives have the light of its nearest end.
    """
    if sensor.response:
        return np.interp(display, sensor.response, np.linspace(0.0, 1.0, len(sensor.response)))
    return srgb_decode(display) if sensor.gamma == 0.0 else display**sensor.gamma


def choose_exposure(background: np.ndarray, sensor: ImageSensor | None = None) -> float:
    """Gain from linear radiance to linear display light; 0 for a black background.

    The strongest channel decides, not luminance: a sensor lit by blue alone would saturate.

    Args:
        background: Linear radiance of the pixels that see the skin, shape (P, 3).
        sensor: Its curve; None is that of sRGB.
    """
    if not background.size:
        return 0.0
    bright = float(np.percentile(background.max(axis=1), BRIGHT_PERCENTILE))
    wanted = float(light_of(np.array(BRIGHT_DISPLAY), sensor or ImageSensor()))
    return wanted / bright if bright > 0.0 else 0.0


def encode(linear: np.ndarray, exposure: np.ndarray | float) -> np.ndarray:
    """8-bit sRGB of linear radiance of any shape; the exposure is a number or one per colour."""
    return looked_up(linear * np.float32(exposure), grey_table(ImageSensor()))


def looked_up(light: np.ndarray, table: np.ndarray) -> np.ndarray:
    """Grey levels of display light of any shape by a table of `LUT_STEPS`, uint8."""
    scaled = np.clip(light * np.float32(LUT_STEPS - 1), 0.0, LUT_STEPS - 1.0)
    return table[(scaled + 0.5).astype(np.uint16)]


@functools.lru_cache(maxsize=8)
def grey_table(sensor: ImageSensor) -> np.ndarray:
    """Grey levels at `LUT_STEPS` even steps of display light from 0 to 1, uint8."""
    return np.round(255.0 * shown(np.arange(LUT_STEPS) / (LUT_STEPS - 1), sensor)).astype(np.uint8)
