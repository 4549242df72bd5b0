"""The image sensor against closed forms: photon transfer, circle of confusion, cos^4, energy."""

from __future__ import annotations

import dataclasses
import math

import numpy as np
import pytest

from sim.optics.camera.camera import focal_px
from sim.optics.raster.display import choose_exposure, encode
from sim.optics.raster.image_sensor import blur_px, defocus, develop, fixed_exposure, noisy
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera, ImageSensor, LensModel

WIDTH, HEIGHT = 160, 120


def camera(sensor: ImageSensor | None = None, **lens: float) -> Camera:
    """A small camera."""
    return Camera(width_px=WIDTH, height_px=HEIGHT, sensor=sensor or ImageSensor(), **lens)  # type: ignore[arg-type]


def scene() -> np.ndarray:
    """Radiance from 0 to 3 without a pattern."""
    random = np.random.default_rng(5)
    return random.uniform(0.0, 3.0, (HEIGHT, WIDTH, 3)).astype(np.float32)


def test_defaults_are_the_plain_display() -> None:
    """Without blur, vignetting, noise and gamma the image is `encode`, to the bit."""
    linear = scene()
    ranges = np.full((HEIGHT, WIDTH), 12.0)
    assert np.array_equal(
        develop(linear, camera(), exposure=0.4, range_mm=ranges), encode(linear, 0.4)
    )


def test_noise_follows_the_photon_transfer_curve() -> None:
    """Variance of light = light g / well + (read g / well)^2, at 0 and 12 dB."""
    for gain_dB in (0.0, 12.0):
        sensor = ImageSensor(
            noise=True, full_well_e=2000.0, read_noise_e=8.0, gain_dB=gain_dB, seed=3
        )
        per_electron = 10.0 ** (gain_dB / 20.0) / 2000.0
        for light in (0.0, 0.05, 0.4, 0.9):
            got = noisy(np.full((400, 400, 3), light, np.float32), camera(sensor), 0)
            exact = light * per_electron + (8.0 * per_electron) ** 2
            # 480,000 samples: the variance of a variance is 2 / n, four sigma are 0.8 %.
            assert got.var() == pytest.approx(exact, rel=0.01)
            assert got.mean() == pytest.approx(light, abs=5.0 * math.sqrt(exact / 480_000))


def test_noise_is_seeded_by_image() -> None:
    """Equal seed and frame give equal images; another frame or seed another one."""
    linear = scene()
    first, again, frame, seed = (
        develop(linear, camera(ImageSensor(noise=True, seed=number)), exposure=0.3, frame=of)
        for number, of in ((1, 0), (1, 0), (1, 1), (2, 0))
    )
    assert np.array_equal(first, again)
    assert not np.array_equal(first, frame) and not np.array_equal(first, seed)


def test_two_cameras_have_noise_of_their_own() -> None:
    """Equal seeds, another place or direction: no correlation above 5 sigma of its own noise."""
    light = np.full((HEIGHT, WIDTH, 3), 0.3, np.float32)
    here = camera(ImageSensor(noise=True, seed=4))
    moved = dataclasses.replace(here, position_mm=(0.0, 0.5, 0.3))
    turned = dataclasses.replace(here, wxyz=(0.0, 0.0, 0.0, 1.0))
    one, two, three = (noisy(light, of, 0).ravel() for of in (here, moved, turned))
    limit = 5.0 / math.sqrt(one.size)
    correlation = np.corrcoef([one, two, three])[np.triu_indices(3, 1)]
    assert (np.abs(correlation) < limit).all()
    assert np.array_equal(one, noisy(light, dataclasses.replace(here), 0).ravel())


def test_circle_of_confusion_is_that_of_a_thin_lens() -> None:
    """Focus 25 mm, aperture 0.7 mm, skin at 10 mm: f 0.7 (1/10 - 1/25) = 0.042 f pixels."""
    blurred = camera(aperture_mm=0.7, focus_mm=25.0)
    sizes = blur_px(blurred, np.array([10.0, 25.0, 50.0, np.nan]))
    f = focal_px(blurred)
    assert sizes == pytest.approx([0.042 * f, 0.0, 0.014 * f, 0.0])


def test_defocus_spreads_a_point_by_its_disc() -> None:
    """The variance along each axis is that of a uniform disc, c^2 / 16, between layers as well."""
    for diameter in (2.0, 5.0, 9.3):
        point = np.zeros((101, 101, 3), np.float32)
        point[50, 50] = 1.0
        spread = defocus(point, np.full((101, 101), diameter / 4.0))[:, :, 0]
        along = np.arange(101) - 50.0
        # The sampled kernels have the variance of their Gaussians to 1 %.
        assert (spread.sum(axis=0) @ along**2) == pytest.approx(diameter**2 / 16.0, rel=0.02)


def test_a_developed_point_has_the_variance_of_its_disc() -> None:
    """A point out of focus, as 8-bit grey: c^2 / 16 along each axis, by the camera's own disc."""
    blurred = camera(ImageSensor(gamma=1.0), aperture_mm=1.5, focus_mm=25.0)
    range_mm = np.full((HEIGHT, WIDTH), 12.5)
    (disc_px,) = blur_px(blurred, range_mm[:1, 0])
    point = np.zeros((HEIGHT, WIDTH, 3), np.float32)
    point[60, 80] = 2.0 * np.pi * disc_px**2 / 16.0
    grey = develop(point, blurred, exposure=0.9, range_mm=range_mm)[:, :, 0].astype(float)
    along = np.arange(WIDTH) - 80.0
    found = (grey.sum(axis=0) @ along**2) / grey.sum()
    # Grey below half a step is cut off: 2 % of the variance.
    assert found == pytest.approx(disc_px**2 / 16.0, rel=0.04)


def test_defocus_loses_no_light() -> None:
    """The sum over the image is the same to single precision, whatever the blur."""
    linear = scene()
    sigma = np.abs(np.linspace(-6.0, 6.0, WIDTH))[None].repeat(HEIGHT, axis=0)
    assert defocus(linear, sigma).sum(dtype=np.float64) == pytest.approx(
        linear.sum(dtype=np.float64), rel=1e-5
    )


def test_pixels_without_a_range_stay_sharp() -> None:
    """Where the line of sight meets nothing the image is that without blur."""
    ranges = np.full((HEIGHT, WIDTH), np.nan)
    linear = scene()
    got = develop(linear, camera(aperture_mm=2.0), exposure=0.3, range_mm=ranges)
    assert np.array_equal(got, encode(linear, 0.3))


def test_vignetting_is_cos4() -> None:
    """A pinhole at 100 degrees: the middle of the left edge has cos^4 50 = 0.1707 of the light."""
    sensor = ImageSensor(vignetting=1.0, gamma=1.0)
    white = np.ones((HEIGHT, WIDTH, 3), np.float32)
    got = develop(white, camera(sensor), exposure=1.0)
    # The first pixel's centre lies half a pixel inside the edge: 0.1737; 8 bits are 0.004.
    assert got[HEIGHT // 2, 0, 0] / 255 == pytest.approx(math.cos(math.radians(50)) ** 4, abs=0.005)
    assert got[HEIGHT // 2, WIDTH // 2, 0] == 255
    half = develop(white, camera(ImageSensor(vignetting=0.5, gamma=1.0)), exposure=1.0)
    assert half[HEIGHT // 2, 0, 0] / 255 == pytest.approx(0.585, abs=0.005)


def test_a_fisheye_of_180_degrees_vignettes_to_black() -> None:
    """cos^4 90 = 0 at the edge, and nothing but 0 beyond it."""
    sensor = ImageSensor(vignetting=1.0, gamma=1.0)
    lens = Camera(
        width_px=WIDTH,
        height_px=HEIGHT,
        lens=LensModel.EQUIDISTANT,
        fov_x_deg=180.0,
        sensor=sensor,
    )
    got = develop(np.ones((HEIGHT, WIDTH, 3), np.float32), lens, exposure=1.0)
    assert got[0, 0, 0] == 0 and got[HEIGHT // 2, 0, 0] == 0


def test_gamma_bends_the_display() -> None:
    """Light 0.5 at gamma 2.2 is 255 x 0.5^(1 / 2.2) = 186."""
    got = develop(
        np.full((HEIGHT, WIDTH, 3), 0.5, np.float32), camera(ImageSensor(gamma=2.2)), exposure=1.0
    )
    assert (got == 186).all()


def test_exposure_is_the_sensors_or_the_backgrounds() -> None:
    """Set to 2 at 20 dB it is 20; at 0 it is what exposes the background, whatever the gain."""
    background = scene().reshape(-1, 3)
    assert fixed_exposure(
        camera(ImageSensor(exposure=2.0, gain_dB=20.0)), background
    ) == pytest.approx(20.0)
    chosen = fixed_exposure(camera(ImageSensor(gain_dB=20.0)), background)
    assert chosen == pytest.approx(choose_exposure(background))
    assert chosen.shape == (3,)


def test_a_gain_per_colour_balances_white() -> None:
    """Twice the red at the same exposure; an exposure that is chosen keeps the ratio of gains."""
    balanced = camera(ImageSensor(exposure=0.5, gain_rgb=(2.0, 1.0, 0.5)))
    background = scene().reshape(-1, 3)
    assert fixed_exposure(balanced, background) == pytest.approx([1.0, 0.5, 0.25])
    free = fixed_exposure(camera(ImageSensor(gain_rgb=(2.0, 1.0, 0.5))), background)
    assert free / free[1] == pytest.approx([2.0, 1.0, 0.5])
    bright = (background * free).max(axis=1)
    assert 0.5 < np.percentile(bright, 99.0) < 0.7, "sRGB 0.8 is 0.604 of the light"


def test_a_measured_falloff_dims_by_its_polynomial() -> None:
    """1 - 0.5 r^2 at the middle of the left edge, where r is 4 / 5 at 4 : 3."""
    sensor = ImageSensor(falloff=(-0.5, 0.0, 0.0), gamma=1.0)
    got = develop(np.ones((HEIGHT, WIDTH, 3), np.float32), camera(sensor), exposure=1.0)
    radius = (WIDTH / 2 - 0.5) / np.hypot(WIDTH / 2, HEIGHT / 2)
    assert got[HEIGHT // 2, 0, 0] / 255 == pytest.approx(1.0 - 0.5 * radius**2, abs=0.004)
    with pytest.raises(DesignError, match=r"leaves -0\.5 of the light"):
        ImageSensor(falloff=(-1.5, 0.0, 0.0))


def test_a_measured_response_replaces_the_curve() -> None:
    """Straight between its values, and refused where it does not rise."""
    sensor = ImageSensor(response=(0.0, 0.6, 1.0))
    flat = np.full((HEIGHT, WIDTH, 3), 0.3, np.float32)
    assert (develop(flat, camera(sensor), exposure=1.0) == round(255 * 0.36)).all()
    with pytest.raises(DesignError, match="does not rise"):
        ImageSensor(response=(0.0, 0.6, 0.6))
