"""Factors of the normal matrix of a reading: vertices are neighbours of few others.

In the order of Cuthill and McKee the matrix of a patch of m vertices is a band as wide as the
patch, some 4 sqrt(m), and its Cholesky factors lie in the band.
Source: George and Liu, Computer solution of large sparse positive definite systems, 1981, ch. 4.
"""

from __future__ import annotations

from typing import Any

import numpy as np


class Banded:
    """Factors of a symmetric positive definite matrix."""

    def __init__(self, matrix: Any, damping: float = 0.0) -> None:
        """Factorise.

        Args:
            matrix: Sparse, shape (m, m).
            damping: Share by which its diagonal is raised.

        Raises:
            numpy.linalg.LinAlgError: If the matrix is not positive definite.
        """
        from scipy.linalg import cholesky_banded
        from scipy.sparse.csgraph import reverse_cuthill_mckee

        rows = matrix.tocsr()
        self._order = reverse_cuthill_mckee(rows, symmetric_mode=True)
        place = np.empty_like(self._order)
        place[self._order] = np.arange(len(place), dtype=place.dtype)
        i = place[np.repeat(np.arange(rows.shape[0]), np.diff(rows.indptr))]
        j = place[rows.indices]
        below = i >= j
        i, j = i[below], j[below]
        band = np.zeros((int((i - j).max(initial=0)) + 1, rows.shape[0]))
        band[i - j, j] = rows.data[below]
        band[0] *= 1.0 + damping
        self._factors = cholesky_banded(band, lower=True, check_finite=False, overwrite_ab=True)

    def solved(self, right: np.ndarray) -> np.ndarray:
        """The solution for right-hand sides, shape (m,) or (m, k)."""
        from scipy.linalg import cho_solve_banded

        found = np.empty_like(right)
        found[self._order] = cho_solve_banded(
            (self._factors, True), right[self._order], check_finite=False
        )
        return found
