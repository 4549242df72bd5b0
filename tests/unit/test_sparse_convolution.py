"""Sparse convolutions against dense ones, finite differences and themselves.

The limits are relative to the largest value: 1e-12 in float64 and 1e-6 in float32, as promised.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import pytest
import torch
from torch import Tensor

from sim.forces.network import products
from sim.forces.network.convolution import convolve
from sim.forces.network.kernel_maps import Table, pair_blocks
from sim.forces.network.levels import Step, coarser, neighbours
from sim.forces.network.reference import at_cells, dense_convolve, dense_down, dense_up, to_dense
from sim.forces.network.strided import down, up

SIZE = 8
CHANNELS, PLANES = 4, 5
LIMITS = {torch.float64: 1e-12, torch.float32: 1e-6}


class Case(NamedTuple):
    """Voxels of a box of 8 x 8 x 8 that are there."""

    coordinates: Tensor
    samples: int

    @property
    def cells(self) -> Tensor:
        """x, y, z."""
        return self.coordinates[:, 1:]


def make_case(share: float, samples: int) -> Case:
    """A box of which a share is filled."""
    generator = torch.Generator().manual_seed(5)
    cells = torch.cartesian_prod(torch.zeros(1, dtype=torch.int64), *[torch.arange(SIZE)] * 3)
    kept = torch.randperm(len(cells), generator=generator)[: round(share * len(cells))]
    return Case(torch.unique(cells[kept], dim=0), samples)


def drawn(*shape: int, dtype: torch.dtype, seed: int) -> Tensor:
    """Normal numbers that want a gradient."""
    generator = torch.Generator().manual_seed(seed)
    return torch.randn(*shape, dtype=dtype, generator=generator).requires_grad_()


def expect_equal(
    sparse: Callable[..., Tensor], dense: Callable[..., Tensor], *operands: Tensor
) -> None:
    """Same values and same gradients by every operand."""
    limit = LIMITS[operands[0].dtype]
    found, expected = sparse(*operands), dense(*operands)
    upstream = drawn(*found.shape, dtype=found.dtype, seed=9).detach()
    pairs = [
        (found, expected),
        *zip(
            torch.autograd.grad(found, operands, upstream),
            torch.autograd.grad(expected, operands, upstream),
            strict=True,
        ),
    ]
    for ours, theirs in pairs:
        error, largest = (ours - theirs).detach().abs().max(), theirs.detach().abs().max()
        assert float(error) <= limit * float(largest)


def make_table(case: Case, edge: int, *, paired: bool) -> Table:
    table = neighbours(case.coordinates, edge)
    blocks = pair_blocks(table, block_voxels=100) if paired else ()
    return Table(neighbours=table, blocks=blocks)


def rows_of(grid: Tensor, case: Case) -> Tensor:
    """Values of a dense grid at the voxels, as rows."""
    return at_cells(grid, case.cells).reshape(-1, grid.shape[1])


def grid_of(rows: Tensor, case: Case) -> Tensor:
    """Rows as a dense grid."""
    return to_dense(rows.view(len(case.cells), case.samples, -1), case.cells, SIZE)


@pytest.mark.parametrize("dtype", LIMITS)
@pytest.mark.parametrize("paired", [False, True])
@pytest.mark.parametrize("edge", [3, 5])
@pytest.mark.parametrize(("share", "samples"), [(1.0, 1), (0.3, 3), (0.02, 2)])
def test_convolution_equals_the_dense_one(
    share: float, samples: int, edge: int, paired: bool, dtype: torch.dtype
) -> None:
    """Full, thin and nearly empty boxes; gathered and as pairs; one sample and some."""
    case = make_case(share, samples)
    table = make_table(case, edge, paired=paired)
    rows = drawn(len(case.cells) * samples, CHANNELS, dtype=dtype, seed=1)
    weight = drawn(edge**3, CHANNELS, PLANES, dtype=dtype, seed=2)
    expect_equal(
        lambda x, w: convolve(x, table, w, samples=samples),
        lambda x, w: rows_of(dense_convolve(grid_of(x, case), w), case),
        rows,
        weight,
    )


@pytest.mark.parametrize("dtype", LIMITS)
@pytest.mark.parametrize(("share", "samples"), [(1.0, 1), (0.3, 3), (0.02, 2)])
def test_down_and_up_equal_the_dense_ones(share: float, samples: int, dtype: torch.dtype) -> None:
    """Kernel 2 and stride 2, and its transpose at the voxels that were there."""
    case = make_case(share, samples)
    coordinates, step = coarser(case.coordinates)
    coarse = Case(coordinates, samples)
    fine_rows = drawn(len(case.cells) * samples, CHANNELS, dtype=dtype, seed=1)
    coarse_rows = drawn(len(coarse.cells) * samples, CHANNELS, dtype=dtype, seed=3)
    weight = drawn(8, CHANNELS, PLANES, dtype=dtype, seed=2)
    expect_equal(
        lambda x, w: down(x, step, w, samples=samples),
        lambda x, w: rows_of(dense_down(grid_of(x, case), w), coarse),
        fine_rows,
        weight,
    )
    expect_equal(
        lambda x, w: up(x, step, w, samples=samples),
        lambda x, w: rows_of(dense_up(grid_of(x, coarse)[:, :, :4, :4, :4], w), case),
        coarse_rows,
        weight,
    )


def small() -> tuple[Case, Step]:
    case = make_case(0.1, 2)
    return case, coarser(case.coordinates)[1]


@pytest.mark.parametrize("paired", [False, True])
def test_gradients_equal_finite_differences_of_the_convolution(paired: bool) -> None:
    """Central differences of every input and weight in float64."""
    case, _ = small()
    table = make_table(case, 3, paired=paired)
    operands = (
        drawn(len(case.cells) * 2, 2, dtype=torch.float64, seed=1),
        drawn(27, 2, 2, dtype=torch.float64, seed=2),
    )
    assert torch.autograd.gradcheck(lambda x, w: convolve(x, table, w, samples=2), operands)


def test_gradients_equal_finite_differences_of_down_and_up() -> None:
    """Central differences of every input and weight in float64."""
    case, step = small()
    weight = drawn(8, 2, 3, dtype=torch.float64, seed=2)
    fine = drawn(len(case.cells) * 2, 2, dtype=torch.float64, seed=1)
    coarse = drawn(len(step.children) * 2, 2, dtype=torch.float64, seed=1)
    assert torch.autograd.gradcheck(lambda x, w: down(x, step, w, samples=2), (fine, weight))
    assert torch.autograd.gradcheck(lambda x, w: up(x, step, w, samples=2), (coarse, weight))


@pytest.mark.parametrize("samples", [1, 3])
def test_chunks_change_no_value(samples: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Chunks of one voxel and of all: the same values and gradients to rounding."""
    case = make_case(0.3, samples)
    table = make_table(case, 3, paired=False)
    rows = drawn(len(case.cells) * samples, CHANNELS, dtype=torch.float64, seed=1)
    weight = drawn(27, CHANNELS, PLANES, dtype=torch.float64, seed=2)

    def chunked(chunk_bytes: int) -> Callable[..., Tensor]:
        def run(x: Tensor, w: Tensor) -> Tensor:
            monkeypatch.setitem(products.CHUNK_BYTES, "cpu", chunk_bytes)
            return convolve(x, table, w, samples=samples)

        return run

    expect_equal(chunked(1), chunked(1 << 30), rows, weight)


@pytest.mark.parametrize("paired", [False, True])
def test_repeated_runs_give_the_same_bits(paired: bool) -> None:
    """Values and gradients of two runs are equal bit by bit."""
    case = make_case(0.5, 2)
    table = make_table(case, 3, paired=paired)
    rows = drawn(len(case.cells) * 2, 16, dtype=torch.float32, seed=1)
    weight = drawn(27, 16, 16, dtype=torch.float32, seed=2)

    def run() -> tuple[Tensor, ...]:
        result = convolve(rows, table, weight, samples=2)
        return (result, *torch.autograd.grad(result.square().sum(), (rows, weight)))

    for first, second in zip(run(), run(), strict=True):
        assert torch.equal(first, second)
