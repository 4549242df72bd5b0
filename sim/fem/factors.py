"""What every solver of linear equations does."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np


class LinearSolver(Protocol):
    """A factorised matrix."""

    name: str

    def factorise(self, matrix: Any) -> int | None:
        """Take a CSR matrix; number of negative pivots if the solver counts them."""
        ...

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        ...

    def solve_many(self, right: np.ndarray) -> np.ndarray:
        """Solutions for the columns of a matrix, shape (E, K)."""
        ...

    def close(self) -> None:
        """Give the memory of the factors back."""
        ...
