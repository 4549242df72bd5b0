"""Direct solution of the linearised equations: MKL's PARDISO where it is installed, else SuperLU.

On a GPU a condensed matrix is factorised densely (`dense_solver`).

The pattern of a body never changes, so PARDISO orders it once. SuperLU orders it anew each time and
takes about three times as long; it knows nothing of inertia, so `negative_pivots` is None there.
Source: Schenk and Gärtner (2004) for PARDISO, Li (2005) for SuperLU.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import sys
from pathlib import Path
from typing import Any

import numpy as np

from sim.fem.dense_solver import MOST_EQUATIONS, DenseSolver
from sim.fem.factors import LinearSolver
from workbench.core.base.errors import SolveError

UNSYMMETRIC, SYMMETRIC_INDEFINITE, POSITIVE = 11, -2, 2
"""PARDISO's types of matrix."""
ORDER, FACTORISE, SUBSTITUTE = 11, 22, 33
"""PARDISO's phases."""
LIBRARY = "PYPARDISO_MKL_RT"
"""Where the wrapper is told its library."""
OPTIONS = {1: 1, 10: 13, 11: 0, 13: 0, 21: 1}
"""PARDISO's `iparm` by place, counted from 1: no matching or scaling, which would order equations
anew by their values, and which elastic tangents do not need."""
MINIMUM_DEGREE, NESTED_DISSECTION = 0, 2
ORDERING = 2
IN_SINGLE = 28
NEGATIVE_PIVOTS = 23
"""Places in PARDISO's `iparm`, counted from 1."""
PIVOTING = 0.01
"""SuperLU: a diagonal entry is kept as pivot down to this share of its column's largest."""


def make_solver(
    *,
    symmetric: bool,
    positive: bool = False,
    single: bool = False,
    block: bool = False,
    device: str = "cpu",
    equations: int = 0,
) -> LinearSolver:
    """The fastest solver that is there, for matrices of one pattern.

    Args:
        symmetric: Whether the matrices are.
        positive: Whether they are positive definite too.
        single: Whether factors in float32 will do: solutions to 1e-6 of their size or better,
            in 0.6 of the time. Newton's method finds the same zero of the same residual by them.
        block: Whether many equations all meet each other. Minimum degree puts those last, in 0.75
            of the time that nested dissection takes, which is twice as fast without them.
        device: `cuda`: a matrix of float32 with such a block is solved there.
        equations: How many there are.
    """
    if device == "cuda" and single and block and equations <= MOST_EQUATIONS:
        spare = functools.partial(
            make_solver, symmetric=symmetric, positive=positive, single=True, block=True
        )
        return DenseSolver(symmetric=symmetric, spare=spare, device=device)
    if has_pardiso():
        return Pardiso(symmetric=symmetric, positive=positive, single=single, block=block)
    return SuperLU(single=single)


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


@functools.cache
def _name_library() -> None:
    """Tell the wrapper where pip puts MKL: it would look through all folders of the environment,
    for a second, each time a solver is made."""
    for path in sorted(Path(sys.prefix, "lib").glob("libmkl_rt.so*")):
        os.environ.setdefault(LIBRARY, str(path))


class Pardiso:
    """MKL's direct solver; holds its memory until it is closed."""

    def __init__(
        self,
        *,
        symmetric: bool,
        positive: bool = False,
        single: bool = False,
        block: bool = False,
    ) -> None:
        _name_library()
        from pypardiso import PyPardisoSolver

        self.name = "PARDISO"
        self._symmetric = symmetric
        kind = SYMMETRIC_INDEFINITE if symmetric else UNSYMMETRIC
        self._solver = PyPardisoSolver(mtype=POSITIVE if positive else kind)
        for place, value in OPTIONS.items():
            self._solver.iparm[place - 1] = value
        self._solver.iparm[ORDERING - 1] = MINIMUM_DEGREE if block else NESTED_DISSECTION
        self._type = np.float32 if single else np.float64
        self._solver.iparm[IN_SINGLE - 1] = int(single)
        self._ordered = False
        self._matrix: Any = None
        self._given: Any = None
        self._upper: np.ndarray | None = None

    def factorise(self, matrix: Any) -> int | None:
        """Take a CSR matrix; of a symmetric one the upper triangle is read."""
        self._given = matrix
        matrix = self._half(matrix) if self._symmetric else matrix
        self._matrix = matrix.astype(self._type)
        zero = np.zeros(matrix.shape[0], self._type)
        # Its public `factorize` compares whole matrices and orders them each time.
        if not self._ordered:
            self._run(ORDER, zero)
            self._ordered = True
        self._run(FACTORISE, zero)
        return int(self._solver.get_iparm(NEGATIVE_PIVOTS)) if self._symmetric else None

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        found = self._once(right)
        if self._type is np.float32:
            # One step of refinement, for the stiff pairs of contact: from 1e-3 to 1e-6.
            found += self._once(right - self._given @ found)
        return found

    def _once(self, right: np.ndarray) -> np.ndarray:
        return self._run(SUBSTITUTE, right.astype(self._type)).ravel().astype(np.float64)

    def solve_many(self, right: np.ndarray) -> np.ndarray:
        """Solutions for the columns of a matrix, shape (E, K)."""
        return self._run(SUBSTITUTE, right.astype(self._type, order="F")).astype(np.float64)

    def _half(self, matrix: Any) -> Any:
        """The upper triangle; where its entries are is found once."""
        from scipy.sparse import csr_matrix

        if self._upper is None:
            rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
            self._upper = np.flatnonzero(matrix.indices >= rows)
            counts = np.bincount(rows[self._upper], minlength=matrix.shape[0])
            self._starts = np.append(0, np.cumsum(counts)).astype(np.int32)
            self._columns = matrix.indices[self._upper]
        data = matrix.data[self._upper]
        return csr_matrix((data, self._columns, self._starts), shape=matrix.shape)

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

    def __init__(self, *, single: bool = False) -> None:
        self.name = "SuperLU"
        self._type = np.float32 if single else np.float64
        self._factors: Any = None
        self._given: Any = None
        self._columns: Any = None

    def factorise(self, matrix: Any) -> int | None:
        """Take a CSR matrix of the pattern of the first one."""
        from scipy.sparse.linalg import splu

        self._given = matrix
        try:
            # A symmetric pattern allows the ordering of A + A^T, which fills in half as much.
            self._factors = splu(
                self._by_columns(matrix),
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

    def _by_columns(self, matrix: Any) -> Any:
        """The matrix in CSC form; where its entries go is found once."""
        from scipy.sparse import csc_matrix, csr_matrix

        if self._columns is None:
            places = np.arange(matrix.nnz)
            self._columns = csr_matrix((places, matrix.indices, matrix.indptr), matrix.shape)
            self._columns = self._columns.tocsc()
        columns = self._columns
        data = matrix.data.astype(self._type)[columns.data]
        return csc_matrix((data, columns.indices, columns.indptr), matrix.shape)

    def solve(self, right: np.ndarray) -> np.ndarray:
        """Solution for a right-hand side, shape (E,)."""
        found = self.solve_many(right)
        if self._type is np.float32:
            found += self.solve_many(right - self._given @ found)
        return found

    def solve_many(self, right: np.ndarray) -> np.ndarray:
        """Solutions for the columns of a matrix, shape (E, K)."""
        return self._factors.solve(right.astype(self._type)).astype(np.float64)

    def close(self) -> None:
        """Give the memory of the factors back."""
        self._factors = None
