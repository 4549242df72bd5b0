"""Direct solution of the linearised equations: MKL's PARDISO where it is installed, else SuperLU.

The pattern of a body never changes, so PARDISO orders it once. SuperLU orders it anew each time and
takes about three times as long; it knows nothing of inertia, so `negative_pivots` is None there.
Source: Schenk and Gärtner (2004) for PARDISO, Li (2005) for SuperLU.
"""

from __future__ import annotations

import functools
import importlib.util
from typing import Any, Protocol

import numpy as np

from workbench.core.errors import SolveError

UNSYMMETRIC = 11
SYMMETRIC_INDEFINITE = -2
ORDER, FACTORISE, SUBSTITUTE = 11, 22, 33
"""PARDISO's phases."""
NEGATIVE_PIVOTS = 23
"""Place in PARDISO's `iparm`, counted from 1."""
PIVOTING = 0.01
"""SuperLU: a diagonal entry is kept as pivot down to this share of its column's largest."""


class LinearSolver(Protocol):
    """A factorised matrix."""

    name: str

    def factorise(self, matrix: Any) -> int | None:
        """Take a CSR matrix; number of negative pivots if the solver counts them."""
        ...

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        ...

    def close(self) -> None:
        """Give the memory of the factors back."""
        ...


def make_solver(*, symmetric: bool) -> LinearSolver:
    """The fastest solver that is installed, for matrices of one pattern."""
    if has_pardiso():
        return Pardiso(symmetric=symmetric)
    return SuperLU()


@functools.cache
def has_pardiso() -> bool:
    """Whether MKL's solver can be used."""
    if importlib.util.find_spec("pypardiso") is None:
        return False
    try:
        Pardiso(symmetric=False)
    except ImportError:
        # The wrapper is there, MKL's library is not.
        return False
    return True


class Pardiso:
    """MKL's direct solver; holds its memory until it is closed."""

    def __init__(self, *, symmetric: bool) -> None:
        from pypardiso import PyPardisoSolver

        self.name = "PARDISO"
        self._symmetric = symmetric
        self._solver = PyPardisoSolver(mtype=SYMMETRIC_INDEFINITE if symmetric else UNSYMMETRIC)
        self._ordered = False
        self._matrix: Any = None

    def factorise(self, matrix: Any) -> int | None:
        """Take a CSR matrix; of a symmetric one the upper triangle is read."""
        if self._symmetric:
            from scipy.sparse import triu

            matrix = triu(matrix, format="csr")
        self._matrix = matrix
        zero = np.zeros(matrix.shape[0])
        # Its public `factorize` compares whole matrices and orders them each time.
        if not self._ordered:
            self._run(ORDER, zero)
            self._ordered = True
        self._run(FACTORISE, zero)
        return int(self._solver.get_iparm(NEGATIVE_PIVOTS)) if self._symmetric else None

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        return self._run(SUBSTITUTE, np.ascontiguousarray(right)).ravel()

    def _run(self, phase: int, right: np.ndarray) -> Any:
        from pypardiso.pardiso_wrapper import PyPardisoError

        self._solver.set_phase(phase)
        try:
            return self._solver._call_pardiso(self._matrix, right)
        except PyPardisoError as error:
            raise SolveError(
                f"the linear solver failed on {self._matrix.shape[0]} equations: {error}",
                hint="lower fem.radius_mm or raise meshing.hex_mm if memory is short",
                at="fem.radius_mm",
            ) from error

    def close(self) -> None:
        """Give the memory of the factors back."""
        if self._ordered:
            self._solver.free_memory(everything=True)
            self._ordered = False


class SuperLU:
    """The portable solver that comes with SciPy."""

    def __init__(self) -> None:
        self.name = "SuperLU"
        self._factors: Any = None

    def factorise(self, matrix: Any) -> int | None:
        """Take a CSR matrix."""
        from scipy.sparse.linalg import splu

        try:
            # A symmetric pattern allows the ordering of A + A^T, which fills in half as much.
            self._factors = splu(
                matrix.tocsc(),
                permc_spec="MMD_AT_PLUS_A",
                diag_pivot_thresh=PIVOTING,
                options={"SymmetricMode": True},
            )
        except (RuntimeError, MemoryError) as error:
            raise SolveError(
                f"the linear solver failed on {matrix.shape[0]} equations: {error}",
                hint="lower fem.radius_mm or raise meshing.hex_mm if memory is short",
                at="fem.radius_mm",
            ) from error
        return None

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        return self._factors.solve(right)

    def close(self) -> None:
        """Give the memory of the factors back."""
        self._factors = None
