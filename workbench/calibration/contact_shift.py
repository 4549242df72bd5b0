"""How far from its circle a contact is: circles are found or drawn to a tenth of their radius.

The predicted change is moved over the photograph until both agree best: Gauss-Newton in the shift,

    photo - predicted(x - s) = 0,   with  d predicted / d s = -grad predicted,

all colours together, in grey levels. Lights and depths are those fitted with the circle as it was.
"""

from __future__ import annotations

import numpy as np

STEPS = 6
MOST = 0.35
"""Of the circle's radius that a contact may be from its middle [1]; more is another contact."""


def contact_shift(predicted: np.ndarray, taken: np.ndarray, usable: np.ndarray) -> np.ndarray:
    """Shift along columns and rows [sample] that brings a prediction onto a photograph.

    Args:
        predicted: Change of grey levels on a regular grid, shape (H, W, 3).
        taken: The photograph's, same shape.
        usable: Where neither is cut off, same shape, bool.
    """
    from scipy import ndimage

    shift = np.zeros(2)
    for _ in range(STEPS):
        moved = np.stack(
            [
                ndimage.shift(predicted[..., c], shift[::-1], order=1, mode="nearest")
                for c in range(3)
            ],
            axis=-1,
        )
        right, down = (np.gradient(moved, axis=axis)[usable] for axis in (1, 0))
        rows = -np.column_stack([right, down])
        square = rows.T @ rows
        if np.linalg.cond(square) > 1e6:
            break
        step = np.linalg.solve(square, rows.T @ (taken - moved)[usable])
        shift += step
        if np.abs(step).max() < 0.01:
            break
    return shift
