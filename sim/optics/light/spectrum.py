"""The colour of a light as linear RGB: from its code, its spectrum, or its colour temperature.

X = sum of S(lambda) xbar(lambda), and so on; RGB = M X with the primaries of sRGB; components below
0 are clipped, since no camera gives less than nothing, and the largest becomes 1: `power` says how
strong a light is. xbar, ybar and zbar are sums of Gaussians of two widths.
Source: Wyman, Sloan, Shirley, "Simple Analytic Approximations to the CIE XYZ Color Matching
Functions", JCGT 2 (2013); M: IEC 61966-2-1; Planck: CODATA 2018.

Three numbers stand for a spectrum: what a real camera's filters make of it, and coatings whose
reflectance changes within one of the three colours, are left out.
"""

from __future__ import annotations

import math

import numpy as np

from workbench.core.design.lighting import SPECTRUM, TEMPERATURE

FWHM_NM = 25.0
"""Full width at half maximum of an LED where none is given [nm]. Source: data sheets of coloured
LEDs, 17 (red, AlInGaP) to 35 nm (green, InGaN)."""
FIRST_NM, LAST_NM, STEP_NM = 340.0, 830.0, 1.0
"""Wavelengths of the sums [nm]."""
SECOND_RADIATION_NM_K = 1.438776877e7
"""h c / k [nm K]. Source: CODATA 2018."""
LOBES = (
    ((1.056, 599.8, 37.9, 31.0), (0.362, 442.0, 16.0, 26.7), (-0.065, 501.1, 20.4, 26.2)),
    ((0.821, 568.8, 46.9, 40.5), (0.286, 530.9, 16.3, 31.1)),
    ((1.217, 437.0, 11.8, 36.0), (0.681, 459.0, 26.0, 13.8)),
)
"""Height [1], peak, width below and width above it [nm] of the lobes of xbar, ybar and zbar."""
TO_SRGB = np.array(
    [[3.2406, -1.5372, -0.4986], [-0.9689, 1.8758, 0.0415], [0.0557, -0.2040, 1.0570]]
)
"""XYZ to linear sRGB. Source: IEC 61966-2-1."""


FAR_RED_NM, FAR_RED_FALL_NM = 690.0, 14.0
"""Where the fit ends, and how fast the responses fall beyond: a tenth every 32 nm in the CIE's
tables."""


def linear_rgb(colour: str) -> tuple[float, float, float]:
    """Linear RGB in [0, 1] of a colour that `check_colour` accepts.

    The digits of `#rrggbb` are linear power, not an sRGB code. `525nm/35nm` is a Gaussian of that
    peak and full width at half maximum, `525nm` has `FWHM_NM`; `5600K` is a black body.
    """
    spectrum, temperature = SPECTRUM.fullmatch(colour), TEMPERATURE.fullmatch(colour)
    if spectrum:
        return _rgb(_gaussian(float(spectrum[1]), float(spectrum[2] or FWHM_NM)))
    if temperature:
        return _rgb(_planck(float(temperature[1])))
    red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
    return red, green, blue


def chromaticity(colour: str) -> tuple[float, float]:
    """CIE 1931 x and y of `525nm`, `525nm/35nm` or `5600K`."""
    spectrum, temperature = SPECTRUM.fullmatch(colour), TEMPERATURE.fullmatch(colour)
    if spectrum:
        power = _gaussian(float(spectrum[1]), float(spectrum[2] or FWHM_NM))
    elif temperature:
        power = _planck(float(temperature[1]))
    else:
        raise ValueError(f"{colour} is no spectrum")
    x, y, z = _matching() @ power
    return float(x / (x + y + z)), float(y / (x + y + z))


def _wavelengths_nm() -> np.ndarray:
    return np.arange(FIRST_NM, LAST_NM + STEP_NM, STEP_NM)


def _matching() -> np.ndarray:
    """xbar, ybar, zbar, shape (3, wavelengths)."""
    every_nm = _wavelengths_nm()
    # The fit's tails cross in the far red, where the eye's responses fall together.
    nm = np.minimum(every_nm, FAR_RED_NM)
    found = np.zeros((3, len(nm)))
    for row, lobes in zip(found, LOBES, strict=True):
        for height, peak, below, above in lobes:
            width = np.where(nm < peak, below, above)
            row += height * np.exp(-0.5 * ((nm - peak) / width) ** 2)
    return found * np.exp(-(every_nm - nm) / FAR_RED_FALL_NM)


def _gaussian(peak_nm: float, fwhm_nm: float) -> np.ndarray:
    sigma = fwhm_nm / (2.0 * math.sqrt(2.0 * math.log(2.0)))
    return np.exp(-0.5 * ((_wavelengths_nm() - peak_nm) / sigma) ** 2)


def _planck(kelvin: float) -> np.ndarray:
    """Spectral power of a black body per wavelength, of any scale."""
    nm = _wavelengths_nm()
    return (560.0 / nm) ** 5 / np.expm1(SECOND_RADIATION_NM_K / (nm * kelvin))


def _rgb(power: np.ndarray) -> tuple[float, float, float]:
    red, green, blue = np.maximum(TO_SRGB @ (_matching() @ power), 0.0)
    most = max(red, green, blue)
    return float(red / most), float(green / most), float(blue / most)
