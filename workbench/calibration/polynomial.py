"""What a calibration without physics would predict: a polynomial in slope and place.

The change of each colour is quadratic in the slopes times quadratic in the place, 36 numbers per
colour. Source: Taxim (Si and Yuan, RA-L 2022) fits six numbers in place for each of 125 x 125
slopes; a product of quadratics needs fewer presses. It is the baseline of every score.
"""

from __future__ import annotations

import numpy as np

from workbench.calibration.residual import Slopes


def terms(seen: Slopes) -> np.ndarray:
    """The 36 products of each pixel, shape (P, 36)."""
    slope, place = _quadratic(seen.slope), _quadratic(seen.place)
    return (slope[:, :, None] * place[:, None, :]).reshape(len(slope), -1)


def fit_polynomial(seen: list[Slopes], change: list[np.ndarray]) -> np.ndarray:
    """Numbers of each colour, (36, 3), from changes of grey levels, (P, 3) of each press."""
    rows = np.concatenate([terms(each) for each in seen])
    return np.linalg.lstsq(rows, np.concatenate(change), rcond=1e-10)[0]


def _quadratic(two: np.ndarray) -> np.ndarray:
    """1, u, v, u^2, u v, v^2, shape (P, 6)."""
    u, v = two[:, 0], two[:, 1]
    return np.column_stack([np.ones_like(u), u, v, u * u, u * v, v * v])
