"""Noise that pixels share, slow changes that are none, and errors drawn like both."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim.reading.block_errors import BlockErrors
from sim.reading.changed import change
from sim.reading.noise import Noise, noise_of

ROWS, COLUMNS = 240, 320
ALL = np.ones((ROWS, COLUMNS), dtype=bool)


def blurred_noise(blur_px: float, seed: int = 1) -> np.ndarray:
    """Noise of 1 grey that is correlated as exp(-r^2 / 4 b^2), shape (H, W, 3)."""
    white = np.random.default_rng(seed).normal(size=(ROWS, COLUMNS, 3)).astype(np.float32)
    kernel = cv2.getGaussianKernel(2 * int(4 * blur_px) + 1, blur_px)
    return cv2.sepFilter2D(white, -1, kernel, kernel) / float((kernel**2).sum())


def disc(radius_px: float) -> np.ndarray:
    """How much of a dent in the middle, 1 inside, shape (H, W, 1)."""
    row, column = np.mgrid[:ROWS, :COLUMNS]
    return (np.hypot(row - 120, column - 160) < radius_px).astype(float)[:, :, None]


def test_white_noise_is_shared_by_one_pixel() -> None:
    """No pixel shares it with a third of another; of its size 3 % are cut off as outliers."""
    white = np.random.default_rng(2).normal(size=(ROWS, COLUMNS, 3))
    found = noise_of(2.0 * white, ALL)
    assert found.grey == pytest.approx(2.0, rel=0.05)
    assert 1.0 <= found.shared_px < 1.3


def test_blurred_noise_is_shared_as_far_as_it_is_blurred() -> None:
    """4 pi b^2 pixels, less what tiles of 16 px cut off: a third, of 50."""
    found = noise_of(blurred_noise(2.0), ALL)
    assert found.grey == pytest.approx(1.0, rel=0.1)
    assert 0.55 < found.shared_px / (16.0 * np.pi) < 1.05


def test_the_mean_of_a_block_is_as_sure_as_its_noise_is_shared() -> None:
    """White: 1 / n. Shared by more pixels than the block has: not surer than one pixel."""
    pixels = np.array([0.0, 1.0, 4.0])
    np.testing.assert_allclose(Noise(grey=2.0).of_block(pixels), [4.0, 4.0, 1.0])
    shared = Noise(grey=2.0, shared_px=9.0)
    np.testing.assert_allclose(shared.of_block(pixels), 4.0)
    assert shared.of_many() == 36.0


def test_noise_that_pixels_share_is_no_change() -> None:
    """2 grey of it all over, which its blur does not lessen; the dent of 15 is found."""
    idle = np.full((ROWS, COLUMNS, 3), 90.0)
    photo = idle + 2.0 * blurred_noise(2.0) + 15.0 * disc(15.0)
    found = change(idle, photo, ALL)
    assert found.certain[disc(12.0)[:, :, 0] > 0.0].all()
    assert not found.certain[disc(20.0)[:, :, 0] == 0.0].any()


def test_slow_changes_are_neither_light_nor_noise() -> None:
    """A slope of .8 grey over the image stays in the photograph, a step of 3 does not."""
    idle = np.full((ROWS, COLUMNS, 3), 90.0)
    slope = np.linspace(-0.4, 0.4, COLUMNS)[None, :, None]
    white = np.random.default_rng(4).normal(size=idle.shape)
    found = change(idle, idle + 3.0 + slope + white + 20.0 * disc(15.0), ALL)
    left = found.photo - idle - slope - white - 20.0 * disc(15.0)
    assert np.abs(left).max() < 0.3
    assert found.noise.shared_px < 1.5
    assert found.certain[disc(12.0)[:, :, 0] > 0.0].all()
    assert not found.certain[disc(20.0)[:, :, 0] == 0.0].any()


def test_a_contact_on_half_of_the_skin_hides_no_noise() -> None:
    """Its noise is that of the other half."""
    idle = np.full((ROWS, COLUMNS, 3), 90.0)
    random = np.random.default_rng(3)
    half = (np.arange(COLUMNS) < COLUMNS // 2)[None, :, None]
    waves = 20.0 * np.sin(np.arange(COLUMNS) / 5.0)[None, :, None]
    found = change(idle, idle + half * waves + random.normal(size=idle.shape), ALL)
    assert found.noise.grey == pytest.approx(1.0, rel=0.1)
    assert found.certain[:, 10:140].mean() > 0.6
    assert not found.certain[:, 180:].any()


def blocks() -> BlockErrors:
    """A grid of 30 x 40 blocks of 2 px."""
    rows, columns = (each.ravel() for each in np.mgrid[10:40, 5:45])
    return BlockErrors(rows, columns, 2)


def test_errors_drawn_are_as_large_as_noise_and_what_is_left() -> None:
    """Where the fit left 3 grey in one half, the square root of 1.5 (9 - 1 / 4) + 1 / 4."""
    left = np.arange(1200) % 40 < 20
    residual = np.where(left, 3.0, 0.0)[:, None] * np.ones(3)
    told = np.full((1200, 3), 4.0)
    drawn = blocks().noise(residual, told, Noise(grey=1.0)).std(axis=2)
    inner = np.arange(1200) % 40
    calm, off = drawn[inner > 32].mean(), drawn[inner < 8].mean()
    assert calm == pytest.approx(0.5, rel=0.05)
    assert off == pytest.approx(np.sqrt(1.5 * 8.75 + 0.25), rel=0.05)


def test_errors_of_the_light_grow_with_the_change() -> None:
    """And are alike in blocks side by side; none of a light that is right at rest."""
    changed = np.linspace(0.0, 20.0, 1200)[:, None] * np.ones(3)
    drawn = blocks().light(changed, 0.02)
    assert drawn[-40:].std() == pytest.approx(0.1 * changed[-40:].mean(), rel=0.35)
    beside = np.corrcoef(drawn[1180:1199].ravel(), drawn[1181:1200].ravel())[0, 1]
    assert beside > 0.95
    assert not blocks().light(changed, 0.0).any()
