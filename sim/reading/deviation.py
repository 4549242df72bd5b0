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
UNKNOWN = 0.3
"""Size of what is not known of the skin, over what the prior allows. Under balls of 8 mm skin bends
by .04 to .1 of that, root mean square over the patch; all of it would make a fit doubt too much
that trusts its photograph little."""
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


def deviations_mm(
    linear: Linear, noise: np.ndarray, light: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Standard deviations of each move, shape (m,) each: by noise and prior, and by the light.

    Args:
        linear: The fit.
        noise: Draws of what each block and colour is off by, whatever is seen [grey],
            shape (P, 3, k).
        light: Likewise, of what grows with the change that is seen.
    """
    random = np.random.default_rng(SEED)
    unknown = UNKNOWN * random.normal(size=(linear.root.shape[0], noise.shape[2]))
    errors = np.concatenate([noise, light], axis=2)
    pulled = (linear.weight[:, :, None] * errors).reshape(-1, errors.shape[2])
    pulls = linear.by_move.T @ (jacobian(linear.slopes).T @ pulled)
    pulls[:, : noise.shape[2]] += linear.root.T @ unknown
    square = linear.factors.solved(pulls) ** 2
    by_noise, by_light = np.split(square, [noise.shape[2]], axis=1)
    return np.sqrt(by_noise.mean(axis=1)), np.sqrt(by_light.mean(axis=1))
