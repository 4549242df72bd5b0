"""Bins of the light by direction: what stands for each, and how light is divided among them."""

from __future__ import annotations

import functools

import numpy as np

from workbench.core.result.light import AZIMUTHS, SINES


@functools.cache
def bin_cosines() -> np.ndarray:
    """Cosine to n that stands for each bin above the horizon, shape (len(SINES) - 1,)."""
    borders = np.array(SINES)
    centres = 0.5 * (borders[1:] + borders[:-1])
    # Light straight along n has a bin centre of its own, or flat skin would look 9 % too dark.
    centres[-1] = 1.0
    return centres


def bin_shares(cosine: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lower of the two bins about each cosine to n, and the share of light of the one above it.

    Light is divided between the two nearest bins so that its perpendicular irradiance and its mean
    cosine both stay: flat skin receives exactly what it should, whatever the width of the bins.
    """
    centres = bin_cosines()
    low = np.clip(np.searchsorted(centres, cosine, side="right") - 1, 0, len(centres) - 2)
    return low, np.clip((cosine - centres[low]) / (centres[low + 1] - centres[low]), 0.0, 1.0)


def sharpened(light: np.ndarray) -> np.ndarray:
    """Light by direction such that its sum with a lobe at the bins' centres has no bias.

    A sum over bins takes a lobe f to be linear from centre to centre, which widens it: its integral
    errs by h^3 f'' / 12 for two centres h apart (the trapezoidal rule's error, e.g. Abramowitz and
    Stegun 25.4.2). Taking h^2 f'' / 12 off at the centres gives the integral back, exactly for
    quadratics; here the transposed operator is applied to the light, once for all lobes. Constants
    and lobes linear in the cosine are summed as before.

    Args:
        light: Perpendicular irradiance, shape (N, 3, B).

    Returns:
        The same shape and, over all bins, the same sum; single bins can be below 0.
    """
    rows = light.reshape(*light.shape[:2], len(SINES) - 1, AZIMUTHS)
    around = np.roll(rows, 1, axis=3) + np.roll(rows, -1, axis=3)
    rows = rows - (around - 2.0 * rows) / 12.0
    return np.einsum("ncka,kl->ncla", rows, _sharpening()).reshape(light.shape)


@functools.cache
def _sharpening() -> np.ndarray:
    """From values at the bins' cosines to values whose linear interpolation has no bias, (K, K)."""
    centres = bin_cosines()
    weights = np.eye(len(centres), dtype=np.float32)
    for k in range(1, len(centres) - 1):
        left, right = centres[k] - centres[k - 1], centres[k + 1] - centres[k]
        share = (left**3 + right**3) / (6.0 * (left + right) ** 2)
        weights[k, k - 1] -= share / left
        weights[k, k] += share / left + share / right
        weights[k, k + 1] -= share / right
    return weights
