"""Scores of one image beside another, their means, and their null."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.optics.proof.comparison import Pair, Scores, compare, decibel, mse_grey2

SHAPE = (24, 32, 3)
BOX = (slice(4, 20), slice(6, 26))


def level(grey: int) -> np.ndarray:
    return np.full(SHAPE, grey, dtype=np.uint8)


def pair(image: int, reference: int, null: int, **labels: str) -> Pair:
    """Three flat images."""
    return Pair(
        image=level(image),
        reference=level(reference),
        null=level(null),
        box=BOX,
        labels=labels,
    )


def of(scores: tuple[Scores, ...], group: str, value: str = "") -> Scores:
    (found,) = [row for row in scores if (row.group, row.value) == (group, value)]
    return found


def test_flat_images_differ_by_their_levels() -> None:
    """100 beside 104 and the null 90: MSE 16 and 196, MAE 4 and 14, PSNR 10 log10(255^2 / MSE)."""
    (row,) = compare([pair(100, 104, 90)])
    assert (row.mse_grey2, row.mae_grey) == (16.0, 4.0)
    assert (row.null_mse_grey2, row.null_mae_grey) == (196.0, 14.0)
    assert row.psnr_dB == pytest.approx(10.0 * math.log10(255.0**2 / 16.0))
    assert row.null_psnr_dB == pytest.approx(10.0 * math.log10(255.0**2 / 196.0))
    # Of flat images only the luminance term of SSIM is left: (2 a b + C1) / (a^2 + b^2 + C1).
    constant = (0.01 * 255.0) ** 2
    assert row.ssim_1 == pytest.approx((2 * 100 * 104 + constant) / (100**2 + 104**2 + constant))


def test_an_image_that_is_its_reference_is_perfect() -> None:
    """SSIM 1, no error, 100 dB."""
    (row,) = compare([pair(104, 104, 90)])
    assert (row.ssim_1, row.mse_grey2, row.mae_grey, row.psnr_dB) == (1.0, 0.0, 0.0, 100.0)


def test_only_the_box_counts() -> None:
    """An error outside the box is not seen; without a box it is."""
    image = level(104)
    image[0] = 0
    inside = Pair(image=image, reference=level(104), null=level(90), box=BOX, labels={})
    whole = Pair(image=image, reference=level(104), null=level(90), box=None, labels={})
    assert compare([inside])[0].mae_grey == 0.0
    assert compare([whole])[0].mae_grey == pytest.approx(104.0 / SHAPE[0])


def test_one_perfect_image_does_not_hide_the_others() -> None:
    """PSNR of a group is that of its mean square error: 16 and 0 make 8."""
    row = of(compare([pair(100, 104, 90), pair(104, 104, 90)]), "all")
    assert row.pairs == 2
    assert row.psnr_dB == pytest.approx(decibel(8.0))


def test_scores_are_broken_down_by_each_label() -> None:
    """Indenters and depths in order of appearance; pairs without a label are in `all` only."""
    scores = compare(
        [
            pair(100, 104, 90, indenter="sphere", depth_mm="0.50"),
            pair(102, 104, 90, indenter="cross", depth_mm="0.50"),
            pair(104, 104, 90, indenter="sphere"),
        ]
    )
    assert [(row.group, row.value, row.pairs) for row in scores] == [
        ("all", "", 3),
        ("indenter", "sphere", 2),
        ("indenter", "cross", 1),
        ("depth_mm", "0.50", 2),
    ]
    assert of(scores, "indenter", "sphere").mse_grey2 == 8.0
    assert of(scores, "indenter", "cross").mae_grey == 2.0
    assert of(scores, "depth_mm", "0.50").mse_grey2 == 10.0


def test_nothing_has_no_scores() -> None:
    """No pairs, no rows."""
    assert compare([]) == ()


def test_a_worse_image_scores_worse_than_the_null() -> None:
    """The null is beaten only by what is nearer to the reference than the background."""
    row = compare([pair(60, 104, 90)])[0]
    assert row.ssim_1 < row.null_ssim_1 and row.psnr_dB < row.null_psnr_dB


def test_squares_do_not_wrap_around() -> None:
    """0 beside 255 in 8 bits: 65025."""
    assert mse_grey2(level(0), level(255)) == 65025.0
