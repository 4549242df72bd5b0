"""Reflection laws and light fields against their closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.optics.field.bake import bake_light
from sim.optics.field.lines import tangential
from sim.optics.light.coating import glossy, phong
from sim.optics.light.lobe import emitted
from sim.optics.proof.checks import irradiance_error, tangency_error_deg
from sim.optics.proof.specimen import finger
from sim.optics.raster.display import choose_exposure, encode, srgb_decode, srgb_encode
from sim.optics.raster.shading import shade
from workbench.core.design.lighting import LedRing, LightModel
from workbench.core.design.optics import Coating
from workbench.core.result.light import LightField

UP = np.array([[0.0, 0.0, 1.0]], dtype=np.float32)
TOWARD_THE_LIGHT = (
    LightModel.LINEAR,
    LightModel.PLANE_TARGET,
    LightModel.PLANE_SOURCE,
    LightModel.PLANE_NORMAL,
    LightModel.DIRECT,
)
"""Models whose light arrives from the side of the LED; a shortest way may go round the body."""
SINGLE = 1e-6
"""Single precision: 6e-8 per operation, a dozen operations."""


def _slanted(angle_deg: float) -> np.ndarray:
    angle = math.radians(angle_deg)
    return np.array([[math.sin(angle), 0.0, math.cos(angle)]], dtype=np.float32)


def test_irradiance_falls_with_the_square_of_distance() -> None:
    """On the axis of a Lambertian LED of power 1, E = 1 / (pi r^2)."""
    down = np.array([[0.0, 0.0, -1.0], [0.0, 0.0, -1.0]])
    got = emitted(down, np.array([10.0, 20.0]), axis=np.array([0.0, 0.0, 1.0]), exponent=1.0)
    assert got == pytest.approx([1 / (100 * math.pi), 1 / (400 * math.pi)])


@pytest.mark.parametrize("exponent", [0.0, 1.0, 5.0])
def test_an_led_emits_its_power(exponent: float) -> None:
    """The integral of irradiance over a hemisphere of radius r is 1 for every exponent."""
    cosine = (np.arange(2000) + 0.5) / 2000
    sine = np.sqrt(1 - cosine**2)
    to_led = -np.column_stack([sine, 0 * sine, cosine])
    received = emitted(to_led, np.full(2000, 7.0), axis=UP[0], exponent=exponent)
    # The midpoint rule with 2000 steps errs by about exponent^2 / (24 * 2000^2).
    assert 2 * math.pi * 49.0 * received.mean() == pytest.approx(1.0, abs=1e-5)


def test_nothing_shines_behind_an_led() -> None:
    """Points behind the LED's plane receive 0, also for an exponent of 0."""
    ahead = np.array([[0.0, 0.0, 1.0]])
    assert emitted(ahead, np.array([5.0]), axis=UP[0], exponent=0.0)[0] == 0.0


def test_direct_field_follows_inverse_square_and_cosine() -> None:
    """E = (m + 1) / (2 pi) cos^m / r^2 at every vertex; the field is stored in float32."""
    ring = LedRing(emission_exponent=2.0, tilt_deg=20.0)
    assert irradiance_error(finger(edge_mm=1.5), ring) < SINGLE


def test_plane_target_field_lies_in_the_skin() -> None:
    """Its angle to the tangent plane is 0 wherever the plane is defined."""
    # The part along n is removed from a vector no shorter than 1e-3, stored in float32.
    assert tangency_error_deg(finger(edge_mm=1.5), LedRing()) < 1e-3


def test_tangential_part_of_light_along_the_normal_is_the_line_itself() -> None:
    """L parallel n spans no plane: the straight line takes its place, without NaN."""
    assert np.array_equal(tangential(UP, UP), UP)


@pytest.mark.parametrize("model", TOWARD_THE_LIGHT)
def test_fields_point_from_the_skin_to_the_light(model: LightModel) -> None:
    """Unit vectors with a positive part along the straight line to the LED."""
    mesh = finger(edge_mm=2.0)
    light = bake_light(mesh, LedRing(), model=model)
    line = light.led_mm[:, None] - mesh.outer.points_mm[None]
    assert (np.einsum("lvi,lvi->lv", light.direction, line) > 0.0).all()
    assert np.linalg.norm(light.direction, axis=2) == pytest.approx(1.0, abs=SINGLE)
    assert light.model == model and light.irradiance.dtype == np.float32


def test_phong_diffuse_is_lambert() -> None:
    """Without gloss I = k_d cos(a), and 0 for light from behind."""
    coating = Coating(phong_diffuse=0.5, phong_specular=0.0)
    for angle_deg, exact in ((0.0, 0.5), (60.0, 0.25), (120.0, 0.0)):
        got = phong(coating, _slanted(angle_deg), UP, UP)[0]
        assert got == pytest.approx(exact, abs=SINGLE)


def test_phong_highlight_peaks_in_the_mirror_direction() -> None:
    """R . V = 1 opposite the light: I = k_s; 20 degrees away it is k_s cos(20)^8."""
    coating = Coating(phong_diffuse=0.0, phong_specular=0.2, phong_exponent=8.0)
    mirror = phong(coating, _slanted(40.0), UP, _slanted(-40.0))[0]
    beside = phong(coating, _slanted(40.0), UP, _slanted(-60.0))[0]
    assert mirror == pytest.approx(0.2, abs=SINGLE)
    assert beside == pytest.approx(0.2 * math.cos(math.radians(20)) ** 8, abs=SINGLE)


def test_glossy_head_on_is_the_closed_form() -> None:
    """At N = L = V: rho (1 - F0) / pi + F0 / (4 pi a^2)."""
    coating = Coating(albedo=0.6, specular=0.04, roughness=0.35)
    exact = 0.6 * 0.96 / math.pi + 0.04 / (4 * math.pi * 0.35**2)
    assert glossy(coating, UP, UP, UP)[0] == pytest.approx(exact, rel=1e-5)


def test_glossy_reflects_alike_in_both_directions() -> None:
    """Helmholtz: swapping light and camera leaves the law (without its cosine) unchanged."""
    coating = Coating()
    there = glossy(coating, _slanted(50.0), UP, _slanted(-20.0))[0] / math.cos(math.radians(50))
    back = glossy(coating, _slanted(-20.0), UP, _slanted(50.0))[0] / math.cos(math.radians(20))
    assert there == pytest.approx(back, rel=1e-5)


@pytest.mark.parametrize("roughness", [0.2, 0.5, 1.0])
def test_glossy_returns_no_more_than_it_receives(roughness: float) -> None:
    """The albedo of a perfect mirror lobe (F0 = 1) is at most 1 at every viewing angle."""
    coating = Coating(albedo=0.0, specular=1.0, roughness=roughness)
    cosine = (np.arange(200) + 0.5) / 200
    azimuth = (np.arange(200) + 0.5) / 200 * 2 * math.pi
    sine = np.sqrt(1 - cosine**2)[:, None]
    grid = [sine * np.cos(azimuth), sine * np.sin(azimuth), np.repeat(cosine[:, None], 200, 1)]
    light = np.stack(grid, axis=-1).reshape(-1, 3).astype(np.float32)
    normal = np.repeat(UP, len(light), axis=0)
    for angle_deg in (0.0, 45.0, 70.0):
        view = np.repeat(_slanted(angle_deg), len(light), axis=0)
        returned = 2 * math.pi * glossy(coating, light, normal, view).mean()
        # The sum over 200 x 200 directions resolves the narrowest lobe (a = 0.2) to 1 %.
        assert 0.3 < returned < 1.01


def test_lights_add_up_by_colour() -> None:
    """A red and a blue LED light the red and the blue channel, each by its own irradiance."""
    light = LightField(
        model="linear",
        direction=np.stack([UP, UP]),
        irradiance=np.array([[1.0], [3.0]], dtype=np.float32),
        led_mm=np.zeros((2, 3)),
        led_axis=np.zeros((2, 3)),
        led_rgb=np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]]),
        led_exponent=np.ones(2),
        led_cone=np.zeros(2),
        led_size_mm=np.ones(2),
    )
    coating = Coating(phong_diffuse=0.5, phong_specular=0.0)
    got = shade(LightModel.LINEAR, light, coating, UP, UP)
    assert got[0] == pytest.approx([0.5, 0.0, 1.5], abs=SINGLE)


def test_srgb_of_18_percent_grey_is_46_percent() -> None:
    """Encoding 0.18 gives 0.4614 (IEC 61966-2-1), and decoding gives 0.18 back."""
    assert srgb_encode(np.array(0.18)) == pytest.approx(0.4614, abs=1e-4)
    assert srgb_decode(srgb_encode(np.array(0.18))) == pytest.approx(0.18)


def test_table_encodes_like_the_formula() -> None:
    """All 8-bit codes of a fine ramp equal the rounded formula or its neighbour at a border."""
    ramp = np.linspace(0.0, 1.2, 10001, dtype=np.float32)
    exact = np.round(255 * srgb_encode(np.minimum(ramp.astype(np.float64), 1.0)))
    difference = np.abs(encode(ramp, 1.0) - exact)
    assert difference.max() <= 1
    assert (difference > 0).mean() < 0.01


def test_exposure_puts_the_bright_end_at_80_percent() -> None:
    """A uniform background of radiance 5 becomes display value 0.8 = code 204."""
    background = np.tile(np.array([[1.0, 5.0, 2.0]], dtype=np.float32), (100, 1))
    assert encode(background, choose_exposure(background))[0, 1] == 204


def test_exposure_of_black_is_zero() -> None:
    """No light, no gain: the caller must say why instead of dividing by zero."""
    assert choose_exposure(np.zeros((10, 3))) == 0.0
