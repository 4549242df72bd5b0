"""Gauss-Newton on residuals that come image by image, and what is known after it.

With residuals r, each over its standard deviation, their derivatives J and a normal prior of mean 0
and standard deviations s on the values z, a step solves

    (J' J + 1 / s^2) step = -(J' r + z / s^2),

and the inverse of the same matrix is the covariance of what is then known (Laplace; Gelman et al.,
Bayesian Data Analysis, 3rd ed., chapter 4). Residuals beside each other are alike, so an
image of N samples is as good as N / A independent ones, A the samples that are alike.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

BANDS, SLOW = 24, 3
"""Of frequency in a spectrum, and those that count as slow."""
HIGHEST = float(np.sqrt(0.5))
"""Frequency of the finest pattern on a grid [1 / sample]."""
LIMIT, NORMAL_MEDIAN = 2.5, 0.6745
"""Standard deviations beyond which a residual counts less [1]; median size of normal ones [1]."""
LOOSE = 1e-9
"""Ridge over the diagonal: values that nothing tells stay where they are."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Rows:
    """Residuals with their derivatives by some of all values."""

    residual: np.ndarray
    """Over the standard deviation of an independent one, shape (N,)."""
    slope: np.ndarray
    """Shape (N, K)."""
    value: np.ndarray
    """Numbers of the K values, shape (K,)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Normal:
    """Normal equations of all rows and the prior, of M values."""

    square: np.ndarray
    """Shape (M, M)."""
    product: np.ndarray
    """Half the gradient of the sum of squares, shape (M,)."""

    def step(self) -> np.ndarray:
        """What to add to all values, shape (M,)."""
        return -np.linalg.solve(self._ridged(), self.product)

    def covariance(self) -> np.ndarray:
        """Of all values, shape (M, M)."""
        return np.linalg.inv(self._ridged())

    def _ridged(self) -> np.ndarray:
        diagonal = np.diag(self.square)
        return self.square + np.diag(LOOSE * np.maximum(diagonal, diagonal.max() * 1e-12))


def normal_equations(rows: Sequence[Rows], now: np.ndarray, prior_sd: np.ndarray) -> Normal:
    """Normal equations.

    Args:
        rows: Of all images.
        now: The values, 0 where the prior has its mean, shape (M,).
        prior_sd: Their standard deviations before; inf is none, shape (M,).
    """
    weight = 1.0 / prior_sd**2
    square, product = np.diag(weight), weight * now
    for each in rows:
        at = np.ix_(each.value, each.value)
        square[at] += each.slope.T @ each.slope
        product[each.value] += each.slope.T @ each.residual
    return Normal(square=square, product=product)


def alike_samples(residuals: Sequence[tuple[np.ndarray, tuple[int, int]]]) -> float:
    """Samples that residuals (N, C), each on its grid, are alike over, at least 1.

    The variance of slow waves over that of all: 1 of noise, the area of a patch where they are
    even over patches. The spectrum is made to fall first (isotonic regression, weighted by the
    number of waves): what is fitted takes from the slow waves, which must not count as known.
    """
    from scipy.optimize import isotonic_regression

    power, modes = np.zeros(BANDS), np.zeros(BANDS)
    for values, (height, width) in residuals:
        waves = np.fft.fft2(values.reshape(height, width, -1), axes=(0, 1), norm="ortho")
        away = np.hypot(np.fft.fftfreq(height)[:, None], np.fft.fftfreq(width)[None, :])
        band = np.round(away / HIGHEST * (BANDS - 1)).astype(int).ravel()
        square = (np.abs(waves) ** 2).mean(axis=-1).ravel()
        power += np.bincount(band, weights=square, minlength=BANDS)
        modes += np.bincount(band, minlength=BANDS)
    weight = np.maximum(modes, 1e-6)
    falling = isotonic_regression(power / weight, weights=weight, increasing=False).x
    whole = float(power.sum() / weight.sum())
    slow = float((falling * weight)[:SLOW].sum() / weight[:SLOW].sum())
    return max(slow / whole, 1.0) if whole > 0.0 else 1.0


def robust_shares(residual: np.ndarray) -> np.ndarray:
    """Share of its square that each residual counts for, (...); 0s do not tell how large they are.

    1 within `LIMIT` standard deviations, by the median of their sizes, falling as 1 / size^4
    beyond: what the model has wrong in one place, such as a wall, must not pull all else there. A
    redescending estimate; Huber and Ronchetti, Robust Statistics, 2nd ed., section 4.8.
    """
    size = np.abs(residual)
    some = size[size > 0.0]
    if not some.size:
        return np.ones(residual.shape)
    limit = LIMIT * float(np.median(some)) / NORMAL_MEDIAN
    return (limit / np.maximum(size, limit)) ** 4
