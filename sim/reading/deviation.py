"""The standard deviations of a fitted displacement: how far other noise would have moved it.

Near its end a fit is a linear one,

    h = M^-1 (J^T W r),    M = J^T W J + P,

of residuals r with weights W under a prior P. Noise e and what the prior does not know of the skin,
p of covariance P^-1, move h by M^-1 (J^T W e - P p). Some of each are drawn, e alike from pixel to
pixel as the photograph's own noise is; the spread of what they do to each vertex is its deviation.
Weights need not be those of the noise for this to be right.
Source: Bardsley, Solonen, Haario and Laine, Randomize-then-optimize, 2014, of a linear problem.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.reading.banded import Banded
from sim.reading.pixels import Slopes, jacobian

DRAWS = 24
"""A standard deviation is then known to a seventh."""
SEED = 1


@dataclass(frozen=True, kw_only=True, slots=True)
class Linear:
    """A fit of m moves to P blocks near its end."""

    factors: Banded
    """Of M, shape (m, m)."""
    slopes: Slopes
    """Of the blocks by the tilts of n vertices."""
    by_move: Any
    """Derivatives of the tilts by the moves, sparse (2 n, m)."""
    weight: np.ndarray
    """W, shape (P, 3)."""
    root: Any
    """R of the prior, P = R^T R, sparse (q, m)."""


def deviation_mm(linear: Linear, errors: np.ndarray) -> np.ndarray:
    """Standard deviation of each move, shape (m,).

    Args:
        linear: The fit.
        errors: Draws of the error of each block and colour [grey], shape (P, 3, k).
    """
    count = errors.shape[2]
    pulled = (linear.weight[:, :, None] * errors).reshape(-1, count)
    by_errors = linear.by_move.T @ (jacobian(linear.slopes).T @ pulled)
    unknown = np.random.default_rng(SEED).normal(size=(linear.root.shape[0], count))
    moved_mm = linear.factors.solved(by_errors + linear.root.T @ unknown)
    return np.sqrt((moved_mm**2).mean(axis=1))
