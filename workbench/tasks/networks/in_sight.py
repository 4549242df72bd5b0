"""Which pixels of a window laid flat the camera sees, and means over these alone.

What is out of sight is black in each image of a window. Left as it is, its edge would stand still
as if it held the skin, and be the steepest of the picture.
"""

from __future__ import annotations

from typing import Any

import numpy as np


def pixels_in_sight(window: np.ndarray) -> np.ndarray:
    """Which pixels of images (T, S, S, 3) are seen, shape (S, S), bool; without any, all are."""
    seen = (window != 0).any(axis=(0, 3))
    return seen if seen.any() else ~seen


def filled(window: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Images (T, S, S, 3) whose pixels out of sight are as the nearest that is seen."""
    from scipy.ndimage import distance_transform_edt

    if seen.all():
        return window
    nearest: Any = distance_transform_edt(~seen, return_distances=False, return_indices=True)
    rows, columns = nearest
    return window[:, rows, columns]


def mean_over(values: np.ndarray, chosen: np.ndarray, seen: np.ndarray) -> np.ndarray:
    """Means of values (T, S, S, ...) over chosen cells (S, S) in sight, shape (T, ...).

    Where none of the chosen is in sight they are those of all that is.
    """
    both = chosen & seen
    return values[:, both if both.any() else seen].mean(axis=1)
