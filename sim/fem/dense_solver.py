"""Direct solution on a GPU: the matrix as a dense one, in float32.

What is left of a part of a membrane once its far field is condensed are 3,000 to 13,000 equations,
a quarter of which all meet each other. A GPU factorises them densely in a tenth of the time that
one core takes sparsely: by Cholesky's method where the matrix is symmetric and positive, else by
Gauss's with partial pivoting (LAPACK's `potrf` and `getrf`). Where the GPU's memory is short, the
processor's solver takes over.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.errors import SolveError

if TYPE_CHECKING:
    from sim.fem.linear_solver import LinearSolver

MOST_EQUATIONS = 16_000
"""Beyond them a matrix takes a GB, and a sparse factorisation is the faster one."""


class DenseSolver:
    """Factors of a dense matrix on a device; holds its memory until it is closed."""

    def __init__(
        self, *, symmetric: bool, spare: Callable[[], LinearSolver], device: str = "cuda"
    ) -> None:
        """Make a solver.

        Args:
            symmetric: Whether the matrices are.
            spare: Makes the solver that takes over when memory is short.
            device: PyTorch's name of the device.
        """
        self.name = "dense factors on the GPU"
        self._symmetric, self._device = symmetric, device
        self._make_spare = spare
        self._spare: LinearSolver | None = None
        self._places: Any = None
        self._given: Any = None
        self._solve: Callable[[Any], Any] | None = None

    def factorise(self, matrix: Any) -> int | None:
        """Take a CSR matrix of the pattern of the first one.

        Returns:
            Of a symmetric matrix 0 where it is positive definite and 1 where it is not.

        Raises:
            SolveError: If it is singular.
        """
        import torch

        if self._spare is not None:
            return self._spare.factorise(matrix)
        self._solve, self._given = None, matrix
        try:
            return self._factorise(matrix)
        except torch.OutOfMemoryError:
            self.close()
            torch.cuda.empty_cache()
            self._spare = self._make_spare()
            self.name = f"{self._spare.name}, as the GPU's memory is short"
            return self._spare.factorise(matrix)

    def _factorise(self, matrix: Any) -> int | None:
        import torch

        dense = self._dense(matrix)
        if self._symmetric:
            lower, failed = torch.linalg.cholesky_ex(dense)
            if not int(failed):
                self._solve = lambda right: torch.cholesky_solve(right, lower)
                return 0
            del lower
        factors, pivots, failed = torch.linalg.lu_factor_ex(dense)
        if int(failed):
            raise SolveError(
                f"the linear solver failed on {matrix.shape[0]} equations: they are singular",
                hint="lower fem.radius_mm or raise meshing.hex_mm",
                at="fem.radius_mm",
            )
        self._solve = lambda right: torch.linalg.lu_solve(factors, pivots, right)
        return 1 if self._symmetric else None

    def _dense(self, matrix: Any) -> Any:
        """The matrix on the device; where its entries go is found once."""
        import torch

        size = matrix.shape[0]
        if self._places is None:
            rows = np.repeat(np.arange(size), np.diff(matrix.indptr))
            self._places = torch.from_numpy(rows * size + matrix.indices).to(self._device)
        values = torch.from_numpy(matrix.data.astype(np.float32)).to(self._device)
        dense = torch.zeros(size * size, device=self._device)
        dense[self._places] = values
        return dense.view(size, size)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        if self._spare is not None:
            return self._spare.solve(right)
        found = self.solve_many(right[:, None])[:, 0]
        # As with PARDISO's factors in float32: one step of refinement.
        return found + self.solve_many((right - self._given @ found)[:, None])[:, 0]

    def solve_many(self, right: np.ndarray) -> np.ndarray:
        """Solutions for the columns of a matrix, shape (E, K)."""
        import torch

        if self._spare is not None:
            return self._spare.solve_many(right)
        assert self._solve is not None
        columns = torch.from_numpy(right.astype(np.float32)).to(self._device)
        return self._solve(columns).cpu().numpy().astype(np.float64)

    def close(self) -> None:
        """Give the memory of the factors back."""
        self._solve = self._places = None
        if self._spare is not None:
            self._spare.close()
