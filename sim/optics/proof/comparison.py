"""Scores of one set of images against another, broken down as the paper's Fig. 5b and 12 do.

SSIM, PSNR, MSE and MAE in the contact box (and over the whole image), each beside the null: what
showing the background instead scores. Sets are paired frame by frame; each pair carries labels
such as indenter, contact angle, depth and position, and scores are averaged over equal labels.
Means of PSNR are taken over the mean squared error, so that one perfect image cannot hide others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim.optics.studio.metrics import PEAK, mae_grey, ssim

Box = tuple[slice, slice]


@dataclass(frozen=True, kw_only=True, slots=True)
class Pair:
    """One image beside its reference."""

    image: np.ndarray
    """sRGB, shape (H, W, 3), uint8."""
    reference: np.ndarray
    """sRGB, shape (H, W, 3), uint8."""
    null: np.ndarray
    """The reference's background, shape (H, W, 3), uint8."""
    box: Box | None
    """Contact box; None takes the whole image."""
    labels: Mapping[str, str]
    """What the pair belongs to, for example {"indenter": "sphere", "depth_mm": "0.5"}."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scores:
    """Means over some pairs, beside those of the null."""

    group: str
    """Label that the pairs share, `all` for all of them."""
    value: str
    pairs: int
    ssim_1: float
    psnr_dB: float
    mse_grey2: float
    mae_grey: float
    null_ssim_1: float
    null_psnr_dB: float
    null_mse_grey2: float
    null_mae_grey: float


def mse_grey2(image: np.ndarray, reference: np.ndarray) -> float:
    """Mean square error in squared grey levels."""
    return float(((image.astype(np.float64) - reference) ** 2).mean())


def decibel(mse: float) -> float:
    """Peak signal to noise ratio [dB] of a mean square error, at most 100."""
    return min(10.0 * float(np.log10(PEAK**2 / mse)), 100.0) if mse > 0.0 else 100.0


def compare(pairs: Sequence[Pair]) -> tuple[Scores, ...]:
    """Scores of all pairs together, then of each value of each label in order of appearance."""
    measured = [(pair, _measure(pair)) for pair in pairs]
    found = [_mean("all", "", [numbers for _, numbers in measured])] if measured else []
    for label in dict.fromkeys(name for pair in pairs for name in pair.labels):
        for value in dict.fromkeys(pair.labels.get(label, "") for pair in pairs):
            chosen = [n for pair, n in measured if pair.labels.get(label, "") == value]
            if value:
                found.append(_mean(label, value, chosen))
    return tuple(found)


def _measure(pair: Pair) -> np.ndarray:
    box = pair.box or (slice(None), slice(None))
    image, truth, null = pair.image[box], pair.reference[box], pair.null[box]
    row = []
    for shown in (image, null):
        row += [ssim(shown, truth), mse_grey2(shown, truth), mae_grey(shown, truth)]
    return np.array(row)


def _mean(group: str, value: str, numbers: Sequence[np.ndarray]) -> Scores:
    mean = np.mean(numbers, axis=0)
    return Scores(
        group=group,
        value=value,
        pairs=len(numbers),
        ssim_1=float(mean[0]),
        psnr_dB=decibel(float(mean[1])),
        mse_grey2=float(mean[1]),
        mae_grey=float(mean[2]),
        null_ssim_1=float(mean[3]),
        null_psnr_dB=decibel(float(mean[4])),
        null_mse_grey2=float(mean[4]),
        null_mae_grey=float(mean[5]),
    )
