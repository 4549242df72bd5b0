"""Bins of the light by direction: what stands for each, and how light is divided among them."""

from __future__ import annotations

import functools

import numpy as np

from workbench.core.result.light import SINES


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
