"""How the shading of a dent changes in a window, as numbers that slip is told by.

A dent that is still pressed in grows while the skin hardly moves, as it does not where all of the
contact slides: then the dent goes on as it is. Dots are taken out first, by closing what is dark
and small. Told is how much differs from image to image, from the first and from the last, and how
far a shift of the whole picture explains it: b = -v . grad I in least squares, which is one step of
the method of Lucas and Kanade (An iterative image registration technique, 1981), with what it
leaves.
"""

from __future__ import annotations

import numpy as np

DOT_PX = 7
"""Side of what counts as small where dots are taken out [px]: more than a dot's."""
SMOOTH_PX = 1.5
"""Blur against noise [px]."""
LEAST_GREY = 0.1
"""Change that counts as none [grey level]."""


def shading_numbers(window: np.ndarray) -> np.ndarray:
    """Numbers of a window of T images (T, S, S, 3) [grey level], shape (6 (T - 1),)."""
    shade = np.stack([without_dots(image) for image in window])
    before, after = shade[:-1], shade[1:]
    changes = (after - before, after - shade[0], before - shade[-1])
    shifts, left = zip(*map(shift_px, before, after), strict=True)
    sizes = [np.sqrt((change**2).mean(axis=(1, 2, 3))) for change in changes]
    logarithms = [np.log(size + LEAST_GREY) for size in (*sizes, np.array(left))]
    return np.concatenate([*logarithms, np.ravel(shifts)])


def without_dots(image: np.ndarray) -> np.ndarray:
    """An image (S, S, 3) without what is dark and small, smoothed, float32."""
    import cv2

    small = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (DOT_PX, DOT_PX))
    grey = np.clip(image, 0, 255).astype(np.uint8)
    closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, small)
    return cv2.GaussianBlur(closed.astype(np.float32), (0, 0), SMOOTH_PX)


def shift_px(before: np.ndarray, after: np.ndarray) -> tuple[np.ndarray, float]:
    """The shift across and down [px] that best explains a change of images (S, S, 3).

    Returns:
        It, and the root mean square of what it leaves [grey level].
    """
    down, across = np.gradient(0.5 * (before + after), axis=(0, 1))
    slopes = np.stack([across.ravel(), down.ravel()], axis=1)
    change = (before - after).ravel()
    shift = np.linalg.lstsq(slopes, change, rcond=None)[0]
    return shift, float(np.sqrt(((change - slopes @ shift) ** 2).mean()))
