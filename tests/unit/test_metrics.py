"""Scores of images and of a press against what can be worked out by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim.optics.studio.metrics import (
    _ratio,
    _stiffness,
    contact_box,
    contact_pixels,
    contrast,
    mae_grey,
    psnr_dB,
    ssim,
)
from workbench.core.result.sensing import TactileFrames


def checkered(amplitude: float) -> np.ndarray:
    """Grey 100, a pixel up and a pixel down by so much in turn."""
    sign = np.indices((64, 64)).sum(axis=0) % 2 * 2 - 1
    return np.repeat((100.0 + amplitude * sign)[:, :, None], 3, axis=2)


def test_structure_is_lost_by_the_constant_of_the_source() -> None:
    """A checker of d against its even mean: C2 / (d^2 + C2), a half where d = 0.03 x 255."""
    even = checkered(0.0)
    assert ssim(checkered(0.03 * 255.0), even) == pytest.approx(0.5, abs=2e-3)
    assert ssim(checkered(0.09 * 255.0), even) == pytest.approx(0.1, abs=2e-3)
    assert ssim(even, even) == 1.0


def test_brightness_alone_costs_the_ratio_of_means() -> None:
    """100 against 50: (2 a b + C1) / (a^2 + b^2 + C1) with C1 = (0.01 x 255)^2."""
    c1 = 2.55**2
    expected = (2 * 100 * 50 + c1) / (100**2 + 50**2 + c1)
    assert ssim(checkered(0.0), checkered(0.0) - 50.0) == pytest.approx(expected)


def test_errors_in_grey_levels() -> None:
    """Everywhere 25.5 off: a mean of 25.5 and 20 dB; equal images have no finite ratio."""
    image, other = np.zeros((4, 4, 3)), np.full((4, 4, 3), 25.5)
    assert mae_grey(image, other) == pytest.approx(25.5)
    assert psnr_dB(image, other) == pytest.approx(20.0)
    assert psnr_dB(image, image) == math.inf
    half = np.where(np.arange(4)[:, None, None] < 2, 0.0, other)
    assert contrast(other, other + half) == pytest.approx(0.5)
    assert contrast(image, other) == 0.0


def frames(*depths_mm: np.ndarray, moved: np.ndarray) -> TactileFrames:
    """Depth images; only what scores of contact read."""
    depth_mm = np.stack(depths_mm).astype(np.float32)
    some: Any = np.zeros((*depth_mm.shape, 3))
    return TactileFrames(
        rgb=some.astype(np.uint8),
        depth_z_mm=depth_mm,
        normal=some.astype(np.float16),
        moved=np.stack([np.zeros_like(moved)] + [moved] * (len(depths_mm) - 1)),
        marker_uv_px=np.zeros((len(depths_mm), 0, 2), np.float32),
        exposure=1.0,
    )


def test_contact_is_where_depth_changed_by_a_tenth_of_the_most_since_the_rest() -> None:
    """Counted from frame 0, not from the frame before; what lost the skin counts, what did not
    move does not."""
    still, first, last = (np.full((3, 4), 30.0) for _ in range(3))
    first[1] = last[1] = [29.0, 29.85, 29.95, 28.0]
    last[2, 0] = np.nan
    moved = np.ones((3, 4), dtype=bool)
    moved[:, 3] = False
    found = contact_pixels(frames(still, first, last, moved=moved), 2)
    expected = np.zeros((3, 4), dtype=bool)
    expected[1, :2] = expected[2, 0] = True
    np.testing.assert_array_equal(found, expected)
    assert contact_box(found) == (slice(1, 3), slice(0, 2))
    assert contact_box(np.zeros((3, 4), dtype=bool)) is None


def test_edges_and_bent_walls_are_no_contact() -> None:
    """A spot of 12 pixels square, 0.5 mm deep. Left out: a line that jumps by 7 mm, a wall as large
    as the spot that moves by 0.2 mm, and a strip of 6 pixels by 2 as deep as the spot."""
    still = np.full((60, 60), 30.0)
    pressed = still.copy()
    pressed[10:22, 10:22] -= 0.5
    pressed[40, :] -= 7.0
    pressed[25:37, 30:42] -= 0.2
    pressed[50:56, 5:7] -= 0.5
    found = contact_pixels(frames(still, pressed, moved=np.ones((60, 60), dtype=bool)), 1)
    assert contact_box(found) == (slice(10, 22), slice(10, 22))
    assert found.sum() == 144


def test_stiffness_is_force_over_the_deepest_inward_way() -> None:
    """2 N at 0.4 mm inward is 5 N/mm; of skin that only moves outward nothing can be said."""
    moved_mm = np.array([[[0.0, 0.0, 0.1], [0.3, 0.0, -0.4]]])
    contact: Any = SimpleNamespace(
        displacement_mm=moved_mm, normal=np.array([0.0, 0.0, 1.0]), normal_N=np.array([2.0])
    )
    assert _stiffness(contact, 0) == pytest.approx(5.0)
    contact.displacement_mm = np.abs(moved_mm)
    assert _stiffness(contact, 0) == 0.0


def test_evenness_is_the_dark_end_over_the_bright_one() -> None:
    """5th over 95th of a hundred; black is 0, not a division by 0."""
    assert _ratio(np.arange(101.0)) == pytest.approx(5.0 / 95.0)
    assert _ratio(np.zeros(9)) == 0.0
