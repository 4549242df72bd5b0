"""Averaging light by direction over neighbouring nodes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix

from sim.optics.transport.smoothing import smoothed_bins
from workbench.core.result.light import AZIMUTHS, SINES

BINS = AZIMUTHS * (len(SINES) - 1)


def frames(*angles_deg: float) -> np.ndarray:
    """Frames about +Z whose t lies at these azimuths."""
    angle = np.radians(angles_deg)
    zero = np.zeros_like(angle)
    t = np.stack([np.cos(angle), np.sin(angle), zero], axis=1)
    b = np.stack([-np.sin(angle), np.cos(angle), zero], axis=1)
    return np.stack([t, b, np.tile([0.0, 0.0, 1.0], (len(angle), 1))], axis=1)


def lit(azimuth_bin: int) -> np.ndarray:
    """Unit light in one bin of the lowest row, all colours."""
    bins = np.zeros((3, BINS), dtype=np.float32)
    bins[:, azimuth_bin] = 1.0
    return bins


def test_one_direction_seen_in_two_frames_stays_one_direction() -> None:
    """Frames 45 degrees (3 bins) apart see the same light 3 bins apart; the mean is that light."""
    bins = np.stack([lit(5), lit(2)])
    half = csr_matrix(np.full((2, 2), 0.5))
    found = smoothed_bins(bins, frames(0.0, 45.0), half)
    assert found == pytest.approx(bins, abs=1e-6)


def test_a_turn_between_bins_is_shared_and_loses_nothing() -> None:
    """7.5 degrees are half a bin: a neighbour's light goes to two bins, its sum is kept."""
    bins = np.stack([np.zeros((3, BINS), dtype=np.float32), lit(4)])
    found = smoothed_bins(bins, frames(0.0, 7.5), csr_matrix([[0.0, 1.0], [0.0, 1.0]]))
    assert found[0, 0, 4] == pytest.approx(0.5, abs=1e-5)
    assert found[0, 0, 5] == pytest.approx(0.5, abs=1e-5)
    assert found.sum() == pytest.approx(6.0, rel=1e-6)
