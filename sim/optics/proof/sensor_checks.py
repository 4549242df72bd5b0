"""Validation of the image sensor and of the colours of lights: closed forms and CIE's tables."""

from __future__ import annotations

import numpy as np

from sim.optics.light.spectrum import chromaticity
from sim.optics.raster.image_sensor import defocus, noisy
from workbench.core.design.camera import Camera, ImageSensor

SIDE_PX = 400
WELL_E, READ_E = 2000.0, 8.0
PLANCKIAN = {
    "2000K": (0.5267, 0.4133),
    "2856K": (0.4475, 0.4075),
    "6500K": (0.3135, 0.3237),
    "10000K": (0.2807, 0.2883),
}
"""CIE 1931 chromaticities of black bodies. Source: CIE 15:2004, colorimetry."""
SPECTRAL = {
    "460nm/1nm": (0.1440, 0.0297),
    "525nm/1nm": (0.1142, 0.8262),
    "580nm/1nm": (0.5125, 0.4866),
    "625nm/1nm": (0.7006, 0.2993),
}
"""CIE 1931 chromaticities of single wavelengths. Source: as above."""


def noise_error() -> tuple[float, float]:
    """Worst relative error [1] of the photon transfer curve at 0 and 12 dB; and the null.

    Variance of light = light g / well + (read g / well)^2. The null is the same without read noise.
    480,000 samples have a variance right to 0.2 %.
    """
    worst = null = 0.0
    for gain_dB in (0.0, 12.0):
        sensor = ImageSensor(
            noise=True, full_well_e=WELL_E, read_noise_e=READ_E, gain_dB=gain_dB, seed=3
        )
        per_electron = 10.0 ** (gain_dB / 20.0) / WELL_E
        for light in (0.0, 0.05, 0.4, 0.9):
            flat = np.full((SIDE_PX, SIDE_PX, 3), light, np.float32)
            found = float(noisy(flat, Camera(sensor=sensor), 0).var(dtype=np.float64))
            shot, read = light * per_electron, (READ_E * per_electron) ** 2
            worst = max(worst, abs(found / (shot + read) - 1.0))
            null = max(null, abs(shot / (shot + read) - 1.0))
    return worst, null


def defocus_error() -> tuple[float, float]:
    """Worst relative errors [1] of a blurred point: of its variance, c^2 / 16, and of its light."""
    along = np.arange(101) - 50.0
    spread_error = light_error = 0.0
    for diameter_px in (2.0, 5.0, 9.3, 20.0):
        point = np.zeros((101, 101, 3), np.float32)
        point[50, 50] = 1.0
        spread = defocus(point, np.full((101, 101), diameter_px / 4.0))[:, :, 0]
        total = float(spread.sum(dtype=np.float64))
        variance = float(spread.sum(axis=0, dtype=np.float64) @ along**2) / total
        spread_error = max(spread_error, abs(variance / (diameter_px**2 / 16.0) - 1.0))
        light_error = max(light_error, abs(total - 1.0))
    return spread_error, light_error


def chromaticity_error(table: dict[str, tuple[float, float]]) -> float:
    """Largest difference [1] of x and y from a table."""
    return max(
        float(np.abs(np.subtract(chromaticity(colour), exact)).max())
        for colour, exact in table.items()
    )
