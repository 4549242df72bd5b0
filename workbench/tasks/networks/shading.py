"""How the shading of a dent changes in a window, as numbers that slip is told by.

A dent that is still pressed in grows while the skin hardly moves, as it does not where all of the
contact slides: then the dent goes on as it is. Dots are taken out first, by closing what is dark
and small, and grey levels are told over their mean, so that exposure does not count. Told is how
much differs from image to image, from the first and from the last, and how far a shift v of the
whole picture explains it, with what it leaves: I(before) - I(after) = v . grad I in least squares.
That is one step of the method of Lucas and Kanade (An iterative image registration technique,
1981), damped, so that a picture without slopes goes nowhere.
"""

from __future__ import annotations

import numpy as np

from workbench.tasks.networks.in_sight import filled, pixels_in_sight

DOT_PX = 7
"""Side of what counts as small where dots are taken out [px]: more than a dot's."""
SMOOTH_PX = 1.5
"""Blur against noise [px]."""
MEAN = 100.0
"""What grey levels are told over their mean by: a number is a percent."""
LEAST = 0.1
"""Change that counts as none [% of the mean grey]."""
LEAST_SLOPE = 0.3
"""Slope below which a picture has none [% of the mean grey per px]."""


def shading_numbers(window: np.ndarray) -> np.ndarray:
    """Numbers of a window of T images (T, S, S, 3) [grey level], shape (6 (T - 1),)."""
    inside = pixels_in_sight(window)
    shade = np.stack([without_dots(image) for image in filled(window, inside)])
    shade *= MEAN / max(float(shade[0, inside].mean()), 1.0)
    before, after = shade[:-1], shade[1:]
    changes = (after - before, after - shade[0], before - shade[-1])
    found = [shift_px(*pair, inside) for pair in zip(before, after, strict=True)]
    shifts, left = zip(*found, strict=True)
    sizes = [np.sqrt((change[:, inside] ** 2).mean(axis=(1, 2))) for change in changes]
    logarithms = [np.log(size + LEAST) for size in (*sizes, np.array(left))]
    return np.concatenate([*logarithms, np.ravel(shifts)])


def without_dots(image: np.ndarray) -> np.ndarray:
    """An image (S, S, 3) without what is dark and small, smoothed, float32."""
    import cv2

    small = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (DOT_PX, DOT_PX))
    grey = np.clip(image, 0, 255).astype(np.uint8)
    closed = cv2.morphologyEx(grey, cv2.MORPH_CLOSE, small)
    return cv2.GaussianBlur(closed.astype(np.float32), (0, 0), SMOOTH_PX)


def shift_px(before: np.ndarray, after: np.ndarray, inside: np.ndarray) -> tuple[np.ndarray, float]:
    """The shift across and down [px] that best explains a change of images (S, S, 3), damped.

    Args:
        before: The first [% of the mean grey].
        after: The second.
        inside: Which pixels count, shape (S, S), bool.

    Returns:
        It, and the root mean square of what it leaves [% of the mean grey].
    """
    middle = 0.5 * (before + after)
    across_and_down = [np.asarray(np.gradient(middle, axis=axis))[inside] for axis in (1, 0)]
    slopes = np.stack([slope.ravel() for slope in across_and_down], axis=1).astype(np.float64)
    change = (before - after)[inside].ravel().astype(np.float64)
    damping = len(slopes) * LEAST_SLOPE**2 * np.eye(2)
    shift = np.linalg.solve(slopes.T @ slopes + damping, slopes.T @ change)
    return shift, float(np.sqrt(((change - slopes @ shift) ** 2).mean()))
