"""Linear radiance to 8-bit sRGB, with one exposure per design. Source: IEC 61966-2-1."""

from __future__ import annotations

import functools

import numpy as np

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


def choose_exposure(background: np.ndarray) -> float:
    """Gain from linear radiance to linear display light; 0 for a black background.

    The strongest channel decides, not luminance: a sensor lit by blue alone would saturate.

    Args:
        background: Linear radiance of the pixels that see the skin, shape (P, 3).
    """
    if not background.size:
        return 0.0
    bright = float(np.percentile(background.max(axis=1), BRIGHT_PERCENTILE))
    return float(srgb_decode(np.array(BRIGHT_DISPLAY))) / bright if bright > 0.0 else 0.0


def encode(linear: np.ndarray, exposure: float) -> np.ndarray:
    """8-bit sRGB of linear radiance of any shape."""
    scaled = np.clip(linear * np.float32(exposure * (LUT_STEPS - 1)), 0.0, LUT_STEPS - 1.0)
    return srgb_table()[(scaled + 0.5).astype(np.uint16)]


@functools.cache
def srgb_table() -> np.ndarray:
    """8-bit sRGB of `LUT_STEPS` even steps of linear light from 0 to 1, uint8."""
    light = np.arange(LUT_STEPS) / (LUT_STEPS - 1)
    return np.round(255.0 * srgb_encode(light)).astype(np.uint8)
