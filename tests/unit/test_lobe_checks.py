"""The second formulas for coating and LED: their own limits, and that they notice a wrong lobe."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.optics.proof import lobe_checks
from workbench.core.design.optics import Coating
from workbench.proof.validation.optics import lobe_rows
from workbench.proof.validation.optics.lobe_rows import DOUBLE_PRECISION, QUADRATURE, too_wide

INK = Coating()


def test_a_sharp_lobe_returns_its_fresnel_reflectance() -> None:
    """a = 0.01: head-on F0 = 0.4 and of the base rho (1 - F0)."""
    sharp = dataclasses.replace(INK, roughness=0.01)
    exact = 0.4 + 0.1 * 0.6
    assert lobe_checks.head_on_returned(sharp) == pytest.approx(exact, abs=1e-3)


def test_facets_of_the_second_formula_cover_the_surface() -> None:
    """The facets' projected areas are 1: with F = 1 the lobe head-on is D G / 4, G = 1 there."""
    white = Coating(albedo=0.0, specular=1.0, roughness=0.4)
    up = np.array([[0.0, 0.0, 1.0]])
    peak = lobe_checks.microfacets(white, up, up)[0]
    assert peak == pytest.approx(1.0 / (4.0 * np.pi * 0.4**2))


def test_the_product_has_the_formula_and_a_wider_lobe_has_not(taichi_device: str) -> None:
    """In double precision and on the device; 30 % wider is off by half, and returns 3.5 % less."""
    assert lobe_checks.lobe_error(INK) < DOUBLE_PRECISION
    assert lobe_checks.lobe_error(INK, lobe_checks.on_device) < lobe_rows.SINGLE_PRECISION
    assert lobe_checks.lobe_error(INK, too_wide) > 0.4
    exact = lobe_checks.head_on_returned(INK)
    assert lobe_checks.returned(INK, 0.0) == pytest.approx(exact, rel=QUADRATURE)
    assert lobe_checks.returned(INK, 0.0, too_wide) < 0.98 * exact


def test_a_lobe_without_its_cosine_is_not_reciprocal() -> None:
    """Light and eye exchanged give the same f; with the light's cosine left in they do not."""

    def leaning(
        coating: Coating, to_light: np.ndarray, normal: np.ndarray, to_eye: np.ndarray
    ) -> np.ndarray:
        return lobe_checks.glossy(coating, to_light, normal, to_eye) * to_light[:, 2]

    assert lobe_checks.reciprocity_error(INK) < DOUBLE_PRECISION
    assert lobe_checks.reciprocity_error(INK, leaning) > 0.5


@pytest.mark.parametrize(("exponent", "cone_deg"), lobe_rows.LEDS)
def test_an_led_sends_out_its_power(taichi_device: str, exponent: float, cone_deg: float) -> None:
    """All of it through a sphere, and of photons the closed form's share near the axis."""
    assert lobe_checks.led_flux(exponent, cone_deg) == pytest.approx(1.0, abs=1e-6)
    exact = lobe_checks.exact_led_share(exponent, cone_deg, 10.0)
    found = lobe_checks.led_share(exponent, cone_deg, 10.0, 50_000)
    assert found == pytest.approx(exact, rel=5e-3)


def test_the_lens_falls_off_as_cos4() -> None:
    """A pinhole; an even image is 0.9 off in the corner."""
    assert lobe_checks.vignetting_error() < 1e-6
    assert lobe_checks.vignetting_error(vignetting=0.0) > 0.8
