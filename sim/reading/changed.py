"""Where a photograph differs from the one at rest, by how much noise, and from what level on.

Of skin that looks calm all changes by one amount, as a lamp that flickers makes it, are taken off.
Slow ones are left: a soft wall gives way a little far around a contact, and that is no light. Noise
is what is left without them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.reading.noise import Noise, noise_of, quiet_grey, some_of

BLUR_PX = 1.5
"""Of the difference, before it is judged: white noise of 1 grey is then .19."""
LEAST_GREY = 1.2
"""Least difference of changed pixels."""
LEAST_SHARE = 0.03
"""And over the largest difference: far from a strong contact it is light that bounced."""
SURE = 4.5
"""And over the standard deviation of blurred noise: of 2,500 places and three colours one in 20
photographs has a larger one."""
REACH_PX = 6
"""How far around changed pixels skin may have moved."""
WIDE = 0.075
"""Of the width of the image: blur of changes that are too slow for noise."""
COARSE = 8
"""Pixels along an edge of those from which such changes are found."""
HELD = 1e-3
"""Least weight of calm pixels around."""
MOST_ROUNDS = 4
"""In which changed pixels and what the others are off by are found from each other."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """Of an image of H x W pixels."""

    photo: np.ndarray
    """The photograph on the level of the one at rest [grey], shape (H, W, 3)."""
    noise: Noise
    """Of the difference where nothing changed."""
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

    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * REACH_PX + 1,) * 2)
    difference = photo.astype(np.float32) - idle.astype(np.float32)
    blurred = cv2.GaussianBlur(difference, (0, 0), BLUR_PX)
    spread_grey = quiet_grey(blurred, sees)
    calm, certain, near = sees, np.zeros_like(sees), np.zeros_like(sees)
    offset: np.ndarray = np.zeros(3)
    slow: np.ndarray = np.zeros_like(difference)
    for _ in range(MOST_ROUNDS):
        if not calm.any():
            break
        offset = np.median(some_of(difference, calm).T.copy(), axis=1)
        sizes = np.maximum.reduce(cv2.split(np.abs(blurred - offset)))
        largest = float(sizes[sees].max(initial=0.0))
        over = sizes > max(LEAST_GREY, LEAST_SHARE * largest, SURE * spread_grey)
        before = certain
        certain = cv2.morphologyEx(over.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3))) > 0
        certain &= sees
        near = cv2.dilate(certain.astype(np.uint8), disc) > 0
        calm = sees & ~near
        slow = _slow(difference, calm)
        if (certain == before).all() or not calm.any():
            break
        left = blurred - slow
        square = cv2.mean(cv2.multiply(left, left), calm.astype(np.uint8))
        spread_grey = float(np.sqrt(max(square[:3])))
    return Change(
        photo=photo - offset,
        noise=noise_of(difference - slow, calm),
        certain=certain,
        near=near,
    )


def _slow(difference: np.ndarray, calm: np.ndarray) -> np.ndarray:
    """What of a difference, (H, W, 3), is alike over many calm pixels, of the same shape.

    Args:
        difference: Of the photographs [grey], shape (H, W, 3).
        calm: Pixels that did not change, shape (H, W), bool.
    """
    import cv2

    rows, columns = calm.shape
    size = (max(1, columns // COARSE), max(1, rows // COARSE))
    share = calm.astype(np.float32)
    weight = cv2.resize(share, size, interpolation=cv2.INTER_AREA)
    summed = cv2.resize(difference * share[:, :, None], size, interpolation=cv2.INTER_AREA)
    blur = WIDE * size[0]
    weight = np.maximum(cv2.GaussianBlur(weight, (0, 0), blur), HELD)[:, :, None]
    mean = cv2.GaussianBlur(summed, (0, 0), blur) / weight
    return cv2.resize(mean, (columns, rows), interpolation=cv2.INTER_LINEAR)
