"""Colours of lights: codes, spectra and black bodies as linear RGB."""

from __future__ import annotations

import numpy as np
import pytest

from sim.optics.light.spectrum import chromaticity, linear_rgb
from workbench.core.base.errors import DesignError
from workbench.core.design.lighting import check_colour


def test_codes_are_linear_power() -> None:
    """#80 is 128/255, not its sRGB decoding of 0.216."""
    assert linear_rgb("#0080ff") == pytest.approx((0.0, 128 / 255, 1.0))


@pytest.mark.parametrize(
    ("kelvin", "x", "y"),
    [
        (2000, 0.5267, 0.4133),
        (2856, 0.4475, 0.4075),
        (6500, 0.3135, 0.3237),
        (10000, 0.2807, 0.2883),
    ],
)
def test_black_bodies_lie_on_the_planckian_locus(kelvin: int, x: float, y: float) -> None:
    """CIE 1931 chromaticities of the locus; the fit of the matching functions errs by 0.004."""
    assert chromaticity(f"{kelvin}K") == pytest.approx((x, y), abs=0.004)


@pytest.mark.parametrize(
    ("nm", "x", "y"),
    [(460, 0.1440, 0.0297), (525, 0.1142, 0.8262), (580, 0.5125, 0.4866), (625, 0.7006, 0.2993)],
)
def test_narrow_lines_lie_on_the_spectral_locus(nm: int, x: float, y: float) -> None:
    """CIE 1931 chromaticities of single wavelengths; the fit errs by up to 0.015 there."""
    assert chromaticity(f"{nm}nm/1nm") == pytest.approx((x, y), abs=0.015)


def test_daylight_is_nearly_white() -> None:
    """A black body of 6500 K has about equal red, green and blue; at 2700 K red is strongest."""
    assert min(linear_rgb("6500K")) > 0.93
    red, green, blue = linear_rgb("2700K")
    assert red == 1.0 and 1.0 > green > blue > 0.0


@pytest.mark.parametrize(
    ("colour", "strongest"), [("625nm", 0), ("525nm", 1), ("460nm", 2), ("1000K", 0), ("20000K", 2)]
)
def test_lights_are_scaled_and_never_negative(colour: str, strongest: int) -> None:
    """The largest component is 1, none is below 0."""
    rgb = linear_rgb(colour)
    assert rgb[strongest] == 1.0 and min(rgb) >= 0.0


def test_a_wider_spectrum_is_paler() -> None:
    """A wide green holds more red and blue than a narrow one."""
    narrow, wide = (np.array(linear_rgb(f"525nm/{width}nm")) for width in (10, 120))
    assert wide[0] + wide[2] > narrow[0] + narrow[2]


@pytest.mark.parametrize(
    ("colour", "says"),
    [
        ("red", "'red' is not of the form #rrggbb, 525nm, 525nm/35nm or 5600K"),
        ("#ff00", "is not of the form"),
        ("1200nm", "peak wavelength 1200 nm is outside 380 to 780 nm"),
        ("525nm/900nm", "width of the spectrum 900 nm is outside"),
        ("90000K", "colour temperature 90000 K is outside 1000 to 20000 K"),
    ],
)
def test_an_unknown_colour_is_refused(colour: str, says: str) -> None:
    """The forms that are known, or the range that was left."""
    with pytest.raises(DesignError) as caught:
        check_colour(colour, at="optics.ring.colours")
    assert says in caught.value.message
    assert caught.value.at == "optics.ring.colours" and caught.value.hint
