"""How well each photograph is predicted, beside what nothing, a polynomial and a repeat would give.

All in the box of the contact, at the photograph's own exposure: the drift that untouched skin shows
is applied to the prediction, to the image at rest that is the null, and to the polynomial alike.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.studio.metrics import psnr_dB, ssim
from workbench.calibration.calibrate import Calibration
from workbench.calibration.light_basis import contact_box
from workbench.calibration.polynomial import fit_polynomial, terms
from workbench.calibration.seen.drift import SeenPhoto, untouched

BEST_dB = 100.0
"""Of equal images, whose ratio is infinite: reports hold finite numbers."""


@dataclass(frozen=True, kw_only=True, slots=True)
class PhotoScore:
    """One photograph."""

    photo: str
    held_out: bool
    depth_mm: float
    ssim: float
    psnr_dB: float
    light_psnr_dB: float
    """Of the fitted light without the residual."""
    null_ssim: float
    null_psnr_dB: float
    polynomial_psnr_dB: float
    repeat_psnr_dB: float
    """Of untouched skin against the image at rest: how alike two photographs are at best."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scored:
    """All photographs, and the sensor at rest in the fitted light alone."""

    photos: tuple[PhotoScore, ...]
    predicted: tuple[np.ndarray, ...]
    """Of each photograph at its own exposure, (H, W, 3), uint8."""
    idle_psnr_dB: float
    idle_ssim: float


def score(found: Calibration, idle: np.ndarray) -> Scored:
    """Score a calibration against its photographs; `idle` is the one at rest, (H, W, 3), uint8."""
    fitted = [k for k, each in enumerate(found.seen) if not each.photo.held_out]
    change = [
        (found.seen[k].at_rest - idle).reshape(-1, 3)[found.by_light.slopes[k].pixel]
        for k in fitted
    ]
    numbers = fit_polynomial([found.by_light.slopes[k] for k in fitted], change)
    scores, shown = [], []
    for number, seen in enumerate(found.seen):
        polynomial = idle.reshape(-1, 3).astype(np.float64)
        slopes = found.by_light.slopes[number]
        polynomial[slopes.pixel] += terms(slopes) @ numbers
        images = {
            "whole": found.predictions.images[number],
            "light": found.by_light.images[number],
            "null": idle,
            "polynomial": polynomial.reshape(idle.shape),
        }
        images = {name: developed(image, seen) for name, image in images.items()}
        shown.append(images["whole"])
        scores.append(_photo_score(seen, images, found.depths_mm[number]))
    return Scored(
        photos=tuple(scores),
        predicted=tuple(shown),
        idle_psnr_dB=_psnr_dB(found.rest, idle),
        idle_ssim=ssim(found.rest, idle),
    )


def developed(image: np.ndarray, seen: SeenPhoto) -> np.ndarray:
    """An image at rest's exposure as the photograph's exposure shows it, uint8."""
    return np.clip(np.round(seen.drift.applied(image)), 0, 255).astype(np.uint8)


def _photo_score(seen: SeenPhoto, images: dict[str, np.ndarray], depth_mm: float) -> PhotoScore:
    taken = seen.photo.image
    box = contact_box(seen.circle, taken.shape[1], taken.shape[0])
    far = untouched(taken.shape, seen.circle)
    ratios = {name: _psnr_dB(image[box], taken[box]) for name, image in images.items()}
    return PhotoScore(
        photo=seen.photo.name,
        held_out=seen.photo.held_out,
        depth_mm=depth_mm,
        ssim=ssim(images["whole"][box], taken[box]),
        psnr_dB=ratios["whole"],
        light_psnr_dB=ratios["light"],
        null_ssim=ssim(images["null"][box], taken[box]),
        null_psnr_dB=ratios["null"],
        polynomial_psnr_dB=ratios["polynomial"],
        repeat_psnr_dB=_psnr_dB(images["null"][far], taken[far]) if far.any() else BEST_dB,
    )


def _psnr_dB(image: np.ndarray, reference: np.ndarray) -> float:
    return min(psnr_dB(image, reference), BEST_dB)
