"""The normal matrix of a fitted displacement: its factors, and the standard deviations it tells."""

from __future__ import annotations

from typing import Any

import numpy as np

PROBES = 24
"""Random vectors: a standard deviation is then known to a sixth."""
SEED = 1


def factorised(matrix: Any) -> Any:
    """Factors of a symmetric sparse matrix (m, m), with `solve`."""
    from scipy.sparse.linalg import splu

    return splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True})


def deviation_mm(matrix: Any) -> np.ndarray:
    """Square root of the diagonal of the inverse of a normal matrix, sparse (m, m): shape (m,).

    Source: Bekas, Kokiopoulou and Saad, An estimator for the diagonal of a matrix, 2007.
    """
    factors = factorised(matrix)
    probes = np.random.default_rng(SEED).choice([-1.0, 1.0], (matrix.shape[0], PROBES))
    return np.sqrt(np.maximum((probes * factors.solve(probes)).mean(axis=1), 0.0))
