"""A smooth surface through measured points: a Gaussian process with a length for each axis.

With the distance r^2 = sum_d ((x_d - x'_d) / l_d)^2 the covariance is Matern's of order 5/2,
k = s (1 + sqrt(5) r + 5/3 r^2) exp(-sqrt(5) r), plus a variance of noise n on the diagonal. The
lengths, s and n maximise the likelihood of the points. Leaving one point out needs no other fit:
the residual is (K^-1 y)_i / (K^-1)_ii.

Source: Rasmussen and Williams, Gaussian Processes for Machine Learning, eqs. 4.17, 5.9 and 5.12.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

LENGTHS = (0.05, 20.0)
"""Shortest and longest of an axis, over that of the unit cube."""
SCALES = (1e-2, 1e3)
NOISES = (1e-6, 1.0)
"""Least and most of the variances, over that of the points."""
BEGIN = (1.0, 1.0, 1e-2)
"""Length, scale and noise that the fit begins with."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Surface:
    """A surface that was fitted."""

    points: np.ndarray
    """In the unit cube, shape (N, D)."""
    values: np.ndarray
    """At the points, shape (N,), in their own unit."""
    lengths: np.ndarray
    """Of the axes, shape (D,)."""
    scale: float
    """Variance s, over that of the values."""
    noise: float
    """Variance n, over that of the values."""
    weights: np.ndarray
    """K^-1 y, shape (N,), of values with mean 0 and variance 1."""
    residual: np.ndarray
    """Of each point from what all others predict, shape (N,), in the unit of the values."""

    def at(self, points: np.ndarray) -> np.ndarray:
        """Values at points (M, D), shape (M,), in the unit of what was fitted."""
        square = _squares(points, self.points) @ self.lengths**-2.0
        near = self.scale * _matern(square)
        return self.values.mean() + _deviation(self.values) * (near @ self.weights)

    @property
    def left_out(self) -> np.ndarray:
        """Values at the points as all others predict them, shape (N,)."""
        return self.values - self.residual


def fit_surface(points: np.ndarray, values: np.ndarray) -> Surface:
    """The surface that makes the points likeliest.

    Args:
        points: In the unit cube, shape (N, D).
        values: At the points, shape (N,).
    """
    from scipy.optimize import minimize

    axes, deviation = points.shape[1], _deviation(values)
    squares = _squares(points, points)
    unit = (values - values.mean()) / deviation
    length, *variances = BEGIN
    begin = np.log([length] * axes + variances)
    bounds = np.log([LENGTHS] * axes + [SCALES, NOISES])
    found = minimize(
        _unlikely, begin, args=(squares, unit), jac=True, method="L-BFGS-B", bounds=bounds
    )
    lengths, (scale, noise) = np.exp(found.x[:axes]), np.exp(found.x[axes:])
    covariance = scale * _matern(squares @ lengths**-2.0) + noise * np.eye(len(points))
    inverse = np.linalg.inv(covariance)
    weights = inverse @ unit
    return Surface(
        points=points,
        values=values,
        lengths=lengths,
        scale=float(scale),
        noise=float(noise),
        weights=weights,
        residual=deviation * weights / np.diag(inverse),
    )


def _unlikely(logs: np.ndarray, squares: np.ndarray, unit: np.ndarray) -> tuple[float, np.ndarray]:
    """Negative log likelihood of values (N,), without its constant, and its slope (D + 2,)."""
    lengths, (scale, noise) = np.exp(logs[:-2]), np.exp(logs[-2:])
    square = squares @ lengths**-2.0
    smooth = scale * _matern(square)
    covariance = smooth + noise * np.eye(len(unit))
    inverse = np.linalg.inv(covariance)
    weights = inverse @ unit
    half = 0.5 * (inverse - np.outer(weights, weights))
    root = np.sqrt(5.0 * square)
    # dk / d log l_d = 5/3 s (1 + sqrt(5) r) exp(-sqrt(5) r) (x_d - x'_d)^2 / l_d^2
    steep = half * (5.0 / 3.0) * scale * (1.0 + root) * np.exp(-root)
    slope = np.array(
        [
            *(np.einsum("ij,ijd->d", steep, squares) * lengths**-2.0),
            float((half * smooth).sum()),
            noise * float(np.trace(half)),
        ]
    )
    return 0.5 * float(unit @ weights) + 0.5 * float(np.linalg.slogdet(covariance)[1]), slope


def _squares(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Squares of differences along each axis, shape (M, N, D)."""
    return (points[:, None] - others[None]) ** 2


def _matern(square: np.ndarray) -> np.ndarray:
    """Matern's correlation of order 5/2 for squares of the distance."""
    root = np.sqrt(5.0 * square)
    return (1.0 + root + 5.0 / 3.0 * square) * np.exp(-root)


def _deviation(values: np.ndarray) -> float:
    """Of values; 1 where they are all the same."""
    found = float(values.std())
    return found if math.isfinite(found) and found > 0.0 else 1.0
