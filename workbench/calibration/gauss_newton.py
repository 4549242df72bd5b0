"""Gauss-Newton on residuals that come image by image, and what is known after it.

With residuals r, each over its standard deviation, their derivatives J and a normal prior of mean 0
and standard deviations s on the values z, a step solves

    (J' J + 1 / s^2) step = -(J' r + z / s^2),

and the inverse of the same matrix is the covariance of what is then known (Laplace; Gelman et al.,
Bayesian Data Analysis, 3rd ed., chapter 4). Residuals beside each other are alike: an image of N
samples is as good as N / A independent ones, A the area that its residuals' autocorrelation covers.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

LEAST_LIKENESS = 0.1
"""Autocorrelation from which residuals count as independent [1]."""
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


def alike_samples(residual: np.ndarray) -> float:
    """Area that residuals on a regular grid, shape (H, W), are alike over [sample], at least 1.

    The autocorrelation, averaged over rings, is summed up to where it first falls below
    `LEAST_LIKENESS`. Missing samples are 0.
    """
    height, width = residual.shape
    spectrum = np.abs(np.fft.rfft2(residual, (2 * height, 2 * width))) ** 2
    together = np.fft.irfft2(spectrum, (2 * height, 2 * width))
    if together[0, 0] <= 0.0:
        return 1.0
    down = np.minimum(np.arange(2 * height), 2 * height - np.arange(2 * height))
    right = np.minimum(np.arange(2 * width), 2 * width - np.arange(2 * width))
    away = np.hypot(down[:, None], right[None, :])
    reach = min(height, width) // 2
    ring = np.round(away).astype(int).ravel()
    count = np.bincount(ring)[: reach + 1]
    mean = np.bincount(ring, weights=together.ravel())[: reach + 1] / np.maximum(count, 1)
    likeness = mean / together[0, 0]
    below = np.flatnonzero(likeness < LEAST_LIKENESS)
    end = int(below[0]) if len(below) else len(likeness)
    return max(float((count * likeness)[:end].sum()), 1.0)
