"""Where a photograph differs from the one at rest, by how much noise, and from what level on.

Light also changes where nothing moved: a lamp flickers, and a contact darkens or lights its
surroundings by light that bounced. What is alike over many pixels where skin is calm is taken for
such light, and carried on into the contact.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.reading.noise import Noise, noise_of, quiet_grey, some

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
"""Of the width of the image: blur of the light that changes where nothing moved."""
COARSE = 8
"""Pixels along an edge of those from which such light is found."""
HELD = 0.02
"""Weight of its median over that of calm pixels all around."""
MOST_ROUNDS = 6
"""In which changed pixels and the light of the others are found from each other."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Change:
    """Of an image of H x W pixels."""

    photo: np.ndarray
    """The photograph in the light of the one at rest [grey], shape (H, W, 3)."""
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
    plain = difference[sees] if sees.any() else np.zeros((1, 3), np.float32)
    light: np.ndarray = np.median(some(plain), axis=0)
    blurred = cv2.GaussianBlur(difference, (0, 0), BLUR_PX)
    spread_grey = quiet_grey(blurred, sees)
    certain = near = np.zeros_like(sees)
    for _ in range(MOST_ROUNDS):
        sizes = np.maximum.reduce(cv2.split(np.abs(blurred - light)))
        largest = float(sizes[sees].max(initial=0.0))
        over = sizes > max(LEAST_GREY, LEAST_SHARE * largest, SURE * spread_grey)
        before = certain
        certain = cv2.morphologyEx(over.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3))) > 0
        certain &= sees
        near = cv2.dilate(certain.astype(np.uint8), disc) > 0
        calm = sees & ~near
        if not calm.any() or (light.ndim > 1 and (certain == before).all()):
            break
        light = _light(difference, calm)
        left = (blurred - light)[calm]
        spread_grey = float(np.sqrt((left**2).mean(axis=0).max()))
    return Change(
        photo=photo - light,
        noise=noise_of(difference - light, sees & ~near),
        certain=certain,
        near=near,
    )


def _light(difference: np.ndarray, calm: np.ndarray) -> np.ndarray:
    """What changed where nothing moved, alike over many pixels, shape (H, W, 3).

    Args:
        difference: Of the photographs [grey], shape (H, W, 3).
        calm: Pixels where nothing moved, shape (H, W), bool; some.
    """
    import cv2

    rows, columns = calm.shape
    size = (max(1, columns // COARSE), max(1, rows // COARSE))
    share = calm.astype(np.float32)
    weight = cv2.resize(share, size, interpolation=cv2.INTER_AREA)
    summed = cv2.resize(difference * share[:, :, None], size, interpolation=cv2.INTER_AREA)
    blur = WIDE * size[0]
    weight = cv2.GaussianBlur(weight, (0, 0), blur)[:, :, None] + HELD
    summed = cv2.GaussianBlur(summed, (0, 0), blur) + HELD * np.median(
        some(difference[calm]), axis=0
    )
    return cv2.resize(summed / weight, (columns, rows), interpolation=cv2.INTER_LINEAR)
