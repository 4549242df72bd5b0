"""Gauss-Newton on residuals that come image by image, and what is known after it.

With residuals r, each over its standard deviation, their derivatives J and a normal prior of mean 0
and standard deviations s on the values z, a step solves

    (J' J + 1 / s^2) step = -(J' r + z / s^2),

and the inverse of the same matrix is the covariance of what is then known (Laplace; Gelman et al.,
Bayesian Data Analysis, 3rd ed., chapter 4). Residuals beside each other are alike: what light does
not explain is smooth over an image. They are independent as waves, each over its own standard
deviation (generalised least squares with a stationary covariance), so what is smooth counts as few
residuals and an edge as many.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

BANDS = 24
"""Of frequency in a spectrum."""
HIGHEST = float(np.sqrt(0.5))
"""Frequency of the finest pattern on a grid [1 / sample]."""
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


@dataclass(frozen=True, kw_only=True, slots=True)
class Spectrum:
    """Variance of residuals by frequency; white residuals have their variance at each."""

    value: np.ndarray
    """At even steps of frequency from 0 to `HIGHEST`, falling, shape (B,)."""

    def over(self, values: np.ndarray, grid: tuple[int, int]) -> np.ndarray:
        """Columns (N, K) of values on a grid over their standard deviations, (N', K)."""
        coefficients, frequency, count = _waves(values, grid)
        at = frequency / HIGHEST * (len(self.value) - 1)
        variance = np.interp(at, np.arange(len(self.value)), self.value)
        whole = coefficients * np.sqrt(count / variance)[..., None]
        flat = whole.reshape(-1, values.shape[1])
        return np.concatenate([np.real(flat), np.imag(flat)])


def spectrum_of(residuals: Sequence[tuple[np.ndarray, tuple[int, int]]], least: float) -> Spectrum:
    """The spectrum of residuals (N, C), each with its grid.

    Their mean square in each band of frequency, made to fall: what is fitted takes from the slow
    ones, which must not count as known for that. `least` is the variance that is left at best.
    """
    power, modes = np.zeros(BANDS), np.zeros(BANDS)
    for values, grid in residuals:
        coefficients, frequency, count = _waves(values, grid)
        band = np.round(frequency / HIGHEST * (BANDS - 1)).astype(int)
        square = (np.abs(coefficients) ** 2).mean(axis=-1) * count
        power += np.bincount(band.ravel(), weights=square.ravel(), minlength=BANDS)
        modes += np.bincount(band.ravel(), weights=count.ravel(), minlength=BANDS)
    mean = np.where(modes > 0.0, power / np.maximum(modes, 1.0), 0.0)
    falling = np.maximum.accumulate(mean[::-1])[::-1]
    return Spectrum(value=np.maximum(falling, least))


def _waves(values: np.ndarray, grid: tuple[int, int]) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coefficients (H, W / 2 + 1, K) of waves, their frequency [1 / sample] and their number.

    The sum of squares is that of the values, where each counts as often as it stands for.
    """
    height, width = grid
    coefficients = np.fft.rfft2(values.reshape(height, width, -1), axes=(0, 1), norm="ortho")
    frequency = np.hypot(np.fft.fftfreq(height)[:, None], np.fft.rfftfreq(width)[None, :])
    count = np.full(frequency.shape, 2.0)
    count[:, 0] = 1.0
    if width % 2 == 0:
        count[:, -1] = 1.0
    return coefficients, frequency, count
