"""Where a photograph differs from the one at rest, by how much noise, and from what level on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

BLUR_PX = 1.5
"""Of the difference, before it is judged: noise of 1 grey is then .19."""
LEAST_GREY = 1.2
"""Least difference of changed pixels."""
LEAST_SHARE = 0.03
"""And over the largest difference: far from a strong contact it is light that bounced."""
LEAST_NOISE_GREY = 0.3
"""Of whole grey levels."""
REACH_PX = 6
"""How far around changed pixels skin may have moved."""
MOST_JUDGED = 20_000
"""Pixels from which offset and noise are found, about: a hundredth of a grey level."""
OUTLYING = 4.0
"""Median sizes beyond which a difference is no noise."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """Of an image of H x W pixels."""

    photo: np.ndarray
    """The photograph on the level of the one at rest [grey], shape (H, W, 3)."""
    noise_grey: float
    """Standard deviation of the difference where nothing changed."""
    certain: np.ndarray
    """Pixels that changed, shape (H, W), bool."""
    near: np.ndarray
    """Those and the ones around them, shape (H, W), bool."""


def change(idle: np.ndarray, photo: np.ndarray, sees: np.ndarray) -> Change:
    """Compare two photographs.

    Args:
        idle: At rest [grey], shape (H, W, 3).
        photo: Touched, likewise.
        sees: Pixels that see the skin, shape (H, W), bool.
    """
    import cv2

    difference = photo.astype(np.float32) - idle.astype(np.float32)
    calm = sees
    offset, noise_grey = np.zeros(3), LEAST_NOISE_GREY
    certain = np.zeros_like(sees)
    for _ in range(2):
        if calm.any():
            quiet = difference[calm][:: max(1, int(np.count_nonzero(calm)) // MOST_JUDGED)]
            offset = np.median(quiet, axis=0)
            noise_grey = max(LEAST_NOISE_GREY, _spread(quiet - offset))
        size = cv2.GaussianBlur(difference - offset, (0, 0), BLUR_PX)
        sizes = np.abs(size).max(axis=2)
        least = max(LEAST_GREY, noise_grey, LEAST_SHARE * float(sizes[sees].max(initial=0.0)))
        over = sizes > least
        certain = cv2.morphologyEx(over.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3))) > 0
        certain &= sees
        calm = sees & ~certain
    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * REACH_PX + 1,) * 2)
    return Change(
        photo=photo - offset,
        noise_grey=noise_grey,
        certain=certain,
        near=cv2.dilate(certain.astype(np.uint8), disc) > 0,
    )


def _spread(values: np.ndarray) -> float:
    """Standard deviation of noise, in whole grey levels too, with some outliers left out."""
    size = np.abs(values)
    plain = size <= OUTLYING * max(float(np.median(size)), 1.0)
    return float(np.sqrt((values[plain] ** 2).mean()))
