"""Scatter into a fixed pattern, and the two direct solvers."""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
import pytest

from sim.fem.dense_solver import DenseSolver
from sim.fem.elements import evaluate, make_elements
from sim.fem.factors import LinearSolver
from sim.fem.linear_solver import Pardiso, SuperLU, has_pardiso, make_solver
from sim.fem.sparse_system import System, freedoms_of, make_system
from sim.fem.studies.blocks import irregular_block
from workbench.core.base.errors import SolveError

SOLVERS = [
    SuperLU,
    pytest.param(
        lambda: Pardiso(symmetric=False),
        marks=pytest.mark.skipif(not has_pardiso(), reason="MKL is not installed"),
        id="Pardiso",
    ),
]


def held_block() -> tuple[System, np.ndarray, np.ndarray]:
    """System, cells and random stiffnesses of a block with a side and a node inside held."""
    points_mm, cells = irregular_block()
    held = points_mm[:, 0] == 0.0
    held[21] = True
    values = np.random.default_rng(0).normal(size=(len(cells), 24, 24))
    return make_system(len(points_mm), cells, held), cells, values


def stiff_block() -> tuple[System, np.ndarray]:
    """System of a block clamped at x = 0, and its element stiffnesses at rest."""
    points_mm, cells = irregular_block()
    elements = make_elements(points_mm, cells, shear_MPa=1.0, bulk_MPa=10.0)
    stiffness = evaluate(elements, np.zeros_like(points_mm), tangent=True).tangent_N_mm
    assert stiffness is not None
    return make_system(len(points_mm), cells, points_mm[:, 0] == 0.0), stiffness


def block_matrix(*, symmetric: bool) -> Any:
    """Stiffness of that block at rest, or with random numbers of 0.02 in its elements."""
    system, stiffness = stiff_block()
    _, cells, _ = held_block()
    skew = np.random.default_rng(5).normal(0.0, 0.02, stiffness.shape)
    return system.matrix((system.slots(cells), stiffness + (0.0 if symmetric else skew)))


def dense(system: System, nodes: np.ndarray, values: np.ndarray) -> np.ndarray:
    full = np.zeros((3 * system.node_count,) * 2)
    for freedoms, block in zip(freedoms_of(nodes), values, strict=True):
        full[np.ix_(freedoms, freedoms)] += block
    return full[np.ix_(system.free, system.free)]


def test_matrix_equals_dense_scatter() -> None:
    """Elements and quadrilaterals of their nodes, added one by one into a dense matrix."""
    system, cells, values = held_block()
    quads = cells[::2, [0, 3, 2, 1]]
    more = np.random.default_rng(1).normal(size=(len(quads), 12, 12))
    found = system.matrix((system.slots(cells), values), (system.slots(quads), more))
    known = dense(system, cells, values) + dense(system, quads, more)
    np.testing.assert_allclose(found.toarray(), known, atol=1e-13)
    assert found.has_sorted_indices


def test_parts_without_groups_add_nothing() -> None:
    system, cells, values = held_block()
    nothing = np.zeros((0, 4), dtype=np.int64)
    found = system.matrix(
        (system.slots(cells), values), (system.slots(nothing), np.zeros((0, 12, 12)))
    )
    np.testing.assert_allclose(found.toarray(), dense(system, cells, values), atol=1e-13)


def test_gather_sums_over_the_groups_of_a_node() -> None:
    system, cells, _ = held_block()
    values = np.random.default_rng(3).normal(size=(len(cells), 24))
    known = np.zeros((system.node_count, 3))
    np.add.at(known, cells, values.reshape(-1, 8, 3))
    np.testing.assert_allclose(system.gather(cells, values), known, atol=1e-14)


def test_reduced_and_expanded_are_inverse() -> None:
    """Free values survive, held ones become zero."""
    system, _, _ = held_block()
    values = np.random.default_rng(4).normal(size=len(system.free))
    field = system.expanded(values)
    np.testing.assert_array_equal(system.reduced(field), values)
    assert np.count_nonzero(field) == len(values)


@pytest.mark.parametrize("make", SOLVERS)
def test_solution_is_that_of_dense_algebra(make: type[SuperLU]) -> None:
    """An unsymmetric matrix on the pattern of a block; 1e-9 leaves room for pivoting."""
    solver: LinearSolver = make()
    matrix = block_matrix(symmetric=False)
    right = np.random.default_rng(6).normal(size=matrix.shape[0])
    assert solver.factorise(matrix) is None
    known = np.linalg.solve(matrix.toarray(), right)
    np.testing.assert_allclose(solver.solve(right), known, rtol=1e-9, atol=1e-9)
    # The same pattern with other values: the order is kept, the factors are not.
    solver.factorise(2.0 * matrix)
    np.testing.assert_allclose(solver.solve(right), 0.5 * known, rtol=1e-9, atol=1e-9)
    solver.close()


@pytest.mark.skipif(not has_pardiso(), reason="MKL is not installed")
def test_negative_pivots_are_counted() -> None:
    """K - s I has as many negative pivots as K has eigenvalues below s (Sylvester)."""
    from scipy.sparse import identity

    matrix = block_matrix(symmetric=True)
    values = np.linalg.eigvalsh(matrix.toarray())
    solver = Pardiso(symmetric=True)
    assert solver.factorise(matrix) == 0
    shift = 0.5 * (values[4] + values[5])
    shifted = (matrix - shift * identity(matrix.shape[0])).tocsr()
    assert solver.factorise(shifted) == 5
    right = np.ones(matrix.shape[0])
    np.testing.assert_allclose(shifted @ solver.solve(right), right, atol=1e-9)
    solver.close()


def dense_solver(*, symmetric: bool) -> DenseSolver:
    """The GPU's solver, on the processor."""
    return DenseSolver(symmetric=symmetric, spare=SuperLU, device="cpu")


@pytest.mark.parametrize("symmetric", [False, True])
def test_dense_factors_in_float32_solve_to_1e_6(symmetric: bool) -> None:
    """An unsymmetric matrix and a positive one on the pattern of a block, then other values."""
    matrix = block_matrix(symmetric=symmetric)
    right = np.random.default_rng(6).normal(size=matrix.shape[0])
    known = np.linalg.solve(matrix.toarray(), right)
    solver = dense_solver(symmetric=symmetric)
    for factor in (1.0, 2.0):
        assert solver.factorise(factor * matrix) == (0 if symmetric else None)
        away = solver.solve(right) * factor - known
        assert np.abs(away).max() < 1e-6 * np.abs(known).max()
    solver.close()


def test_a_dense_matrix_that_is_not_positive_is_told_and_solved() -> None:
    """K - s I with s above the lowest eigenvalue."""
    from scipy.sparse import identity

    matrix = block_matrix(symmetric=True)
    values = np.linalg.eigvalsh(matrix.toarray())
    shifted = (matrix - 0.5 * (values[4] + values[5]) * identity(matrix.shape[0])).tocsr()
    solver = dense_solver(symmetric=True)
    assert solver.factorise(matrix) == 0
    assert solver.factorise(shifted) == 1
    right = np.ones(matrix.shape[0])
    known = np.linalg.solve(shifted.toarray(), right)
    np.testing.assert_allclose(solver.solve(right), known, atol=1e-6 * np.abs(known).max())


@pytest.mark.parametrize("call", ["lu_factor_ex", "lu_solve"])
@pytest.mark.parametrize("error", ["OutOfMemoryError", "RuntimeError"])
def test_the_processor_takes_over_when_the_gpu_fails(
    call: str, error: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """In either step, from then on; the name says why, and nothing of the GPU's is held."""
    import torch
    from scipy.sparse import identity

    kind = {"OutOfMemoryError": torch.OutOfMemoryError, "RuntimeError": RuntimeError}[error]
    held: list[weakref.ref[object]] = []

    def refuse(tensor: object, *_: object, **__: object) -> None:
        held.append(weakref.ref(tensor))
        raise kind("CUSOLVER_STATUS_ALLOC_FAILED")

    def spare() -> SuperLU:
        assert all(ref() is None for ref in held)
        return SuperLU()

    matrix = (2.0 * identity(5)).tocsr()
    solver = DenseSolver(symmetric=False, spare=spare, device="cpu")
    solver.factorise(matrix)
    monkeypatch.setattr(torch.linalg, call, refuse)
    for _ in range(2):
        solver.factorise(matrix)
        np.testing.assert_allclose(solver.solve(np.ones(5)), 0.5)
        np.testing.assert_allclose(solver.solve_many(np.ones((5, 2))), 0.5)
    assert solver.name == "SuperLU, as the GPU failed: CUSOLVER_STATUS_ALLOC_FAILED"
    assert len(held) == 1
    solver.close()


@pytest.mark.gpu
@pytest.mark.parametrize("symmetric", [False, True])
def test_a_gpu_solves_and_gives_its_memory_back(symmetric: bool) -> None:
    """Positive, unsymmetric and indefinite matrices on the device itself."""
    import torch

    matrix = block_matrix(symmetric=symmetric)
    right = np.random.default_rng(6).normal(size=matrix.shape[0])
    # The first product of a process brings cuBLAS a workspace (32 MiB on an H100), which stays.
    one = torch.eye(2, dtype=torch.float64, device="cuda")
    assert float((one @ one).sum()) == 2.0
    before = torch.cuda.memory_allocated()
    solver = DenseSolver(symmetric=symmetric, spare=SuperLU)
    for sign, negative in ((1.0, 0), (-1.0, 1)):
        assert solver.factorise(sign * matrix) == (negative if symmetric else None)
        known = np.linalg.solve(sign * matrix.toarray(), right)
        assert np.abs(solver.solve(right) - known).max() < 1e-6 * np.abs(known).max()
    solver.close()
    assert solver.name == "dense factors on the GPU"
    assert torch.cuda.memory_allocated() <= before


def test_a_gpu_takes_condensed_matrices_of_float32_that_fit() -> None:
    def name(**changed: object) -> str:
        asked: dict[str, Any] = {"single": True, "block": True, "device": "cuda", "equations": 5000}
        return make_solver(symmetric=False, **(asked | changed)).name

    assert name() == "dense factors on the GPU"
    processor = name(device="cpu")
    assert processor in ("PARDISO", "SuperLU")
    assert name(equations=20_000) == name(single=False) == name(block=False) == processor


def test_a_dense_matrix_without_inverse_is_an_error_with_a_remedy() -> None:
    from scipy.sparse import csr_matrix

    with pytest.raises(SolveError, match="3 equations: they are singular") as caught:
        dense_solver(symmetric=False).factorise(csr_matrix(np.diag([1.0, 0.0, 1.0])))
    assert "fem.radius_mm" in caught.value.hint


def test_singular_matrix_is_an_error_with_a_remedy() -> None:
    from scipy.sparse import csr_matrix

    with pytest.raises(SolveError, match="failed on 3 equations") as caught:
        SuperLU().factorise(csr_matrix(np.diag([1.0, 0.0, 1.0])))
    assert "fem.radius_mm" in caught.value.hint


def test_the_fastest_installed_solver_is_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sim.fem.linear_solver.has_pardiso", lambda: False)
    assert make_solver(symmetric=True).name == "SuperLU"
