"""Direct solution on a GPU: the matrix as a dense one, in float32.

What is left of a part of a membrane once its far field is condensed are 3,000 to 13,000 equations,
a quarter of which all meet each other. A GPU factorises them densely in a tenth of the time that
one core takes sparsely: by Cholesky's method where the matrix is symmetric and positive, else by
Gauss's with partial pivoting (LAPACK's `potrf` and `getrf`). Where the GPU has no memory left, or
fails otherwise, the processor's solver takes over, and the name says so.
"""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from workbench.core.base.errors import SolveError

if TYPE_CHECKING:
    from sim.fem.factors import LinearSolver

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
            spare: Makes the solver that takes over when the device fails.
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
        self._solve, self._given = None, matrix
        if self._spare is None:
            try:
                return self._factorise(matrix)
            except RuntimeError as error:
                why = str(error)
            # Not before here: the error holds what was on the device.
            self._give_up(why)
        assert self._spare is not None
        return self._spare.factorise(matrix)

    def _factorise(self, matrix: Any) -> int | None:
        import torch

        if not self._symmetric:
            self._solve = self._gauss(matrix)
            return None
        lower, failed = torch.linalg.cholesky_ex(self._dense(matrix))
        if int(failed):
            # Its equations are seldom solved: a matrix that is positive comes instead.
            return 1

        def solve(right: Any) -> Any:
            half = torch.linalg.solve_triangular(lower, right, upper=False)
            return torch.linalg.solve_triangular(lower.mT, half, upper=True)

        self._solve = solve
        return 0

    def _gauss(self, matrix: Any) -> Callable[[Any], Any]:
        import torch

        factors, pivots, failed = torch.linalg.lu_factor_ex(self._dense(matrix))
        if int(failed):
            raise SolveError(
                f"the linear solver failed on {matrix.shape[0]} equations: they are singular",
                hint="lower fem.radius_mm or raise meshing.hex_mm",
                at="fem.radius_mm",
            )
        return lambda right: torch.linalg.lu_solve(factors, pivots, right)

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

    def _give_up(self, why: str) -> None:
        """Let the processor's solver take over for good."""
        self.close()
        self._spare = self._make_spare()
        self.name = f"{self._spare.name}, as the GPU failed: {why.splitlines()[0][:80]}"

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        if self._spare is None:
            found = self.solve_many(right[:, None])[:, 0]
            # Asked again: the GPU may have failed just now.
            if self._spare is None:
                # As with PARDISO's factors in float32: one step of refinement.
                return found + self.solve_many((right - self._given @ found)[:, None])[:, 0]
        return self._spare.solve(right)

    def solve_many(self, right: np.ndarray) -> np.ndarray:
        """Solutions for the columns of a matrix, shape (E, K)."""
        if self._spare is None:
            try:
                return self._solve_many(right)
            except RuntimeError as error:
                why = str(error)
            given = self._given
            self._give_up(why)
            assert self._spare is not None
            self._spare.factorise(given)
        return self._spare.solve_many(right)

    def _solve_many(self, right: np.ndarray) -> np.ndarray:
        import torch

        if self._solve is None:
            self._solve = self._gauss(self._given)
        columns = torch.from_numpy(right.astype(np.float32)).to(self._device)
        return self._solve(columns).cpu().numpy().astype(np.float64)

    def close(self) -> None:
        """Give the memory of the factors back, to other processes too."""
        self._solve = self._places = self._given = None
        if self._device == "cuda":
            import torch

            with contextlib.suppress(RuntimeError):
                torch.cuda.empty_cache()
        if self._spare is not None:
            self._spare.close()
