"""The standard deviations that the normal matrix of a fitted displacement tells."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.reading.banded import Banded

PROBES = 24
"""Random vectors: a standard deviation is then known to a sixth."""
SEED = 1


def deviation_mm(matrix: Any) -> np.ndarray:
    """Square root of the diagonal of the inverse of a normal matrix, sparse (m, m): shape (m,).

    Source: Bekas, Kokiopoulou and Saad, An estimator for the diagonal of a matrix, 2007.
    """
    probes = np.random.default_rng(SEED).choice([-1.0, 1.0], (matrix.shape[0], PROBES))
    return np.sqrt(np.maximum((probes * Banded(matrix).solved(probes)).mean(axis=1), 0.0))
