"""Neighbours and coarser levels against a dictionary of voxels."""

from __future__ import annotations

import pytest
import torch
from torch import Tensor

from sim.forces.network.kernel_maps import Kernel, kernel_maps, padded, pair_blocks
from sim.forces.network.levels import coarser, keys, neighbours, offsets
from sim.forces.network.segments import segments
from sim.forces.network.voxels import Voxels


def some_voxels(count: int, *, seed: int, size: int = 7, membranes: int = 2) -> Tensor:
    """Different voxels of a box, sorted; some coordinates are negative."""
    generator = torch.Generator().manual_seed(seed)
    cells = torch.cartesian_prod(torch.arange(membranes), *[torch.arange(size) - 3] * 3)
    chosen = cells[torch.randperm(len(cells), generator=generator)[:count]]
    return torch.unique(chosen, dim=0)


def as_voxels(coordinates: Tensor) -> Voxels:
    """Voxels with one point each."""
    own = torch.arange(len(coordinates))
    return Voxels(
        coordinates=coordinates,
        voxel_of_point=own,
        points=segments(own, count=len(coordinates)),
    )


@pytest.mark.parametrize("edge", [3, 5])
@pytest.mark.parametrize("count", [1, 40, 686])
def test_neighbours_equal_those_of_a_dictionary(edge: int, count: int) -> None:
    """Voxel at each offset, in the same membrane only; none is N."""
    coordinates = some_voxels(count, seed=count)
    number = {tuple(cell): place for place, cell in enumerate(coordinates.tolist())}
    steps = offsets(edge).tolist()
    expected = [
        [number.get((b, x + i, y + j, z + k), count) for i, j, k in steps]
        for b, x, y, z in coordinates.tolist()
    ]
    assert neighbours(coordinates, edge).tolist() == expected


def test_keys_sort_as_coordinates_do() -> None:
    """Lexicographic order of (membrane, x, y, z) is that of the keys."""
    assert bool((keys(some_voxels(500, seed=1)).diff() > 0).all())


def test_coarser_level_halves_toward_minus_infinity() -> None:
    """Parents are floor(c / 2), sorted and unique; children and parents undo each other."""
    coordinates = some_voxels(200, seed=2)
    coarse, step = coarser(coordinates)
    halves = coordinates.clone()
    halves[:, 1:] = torch.floor(coordinates[:, 1:] / 2).long()
    assert torch.equal(coarse, torch.unique(halves, dim=0))
    assert torch.equal(coarse[step.parent], halves)
    assert torch.equal(step.children[step.parent, step.octant], torch.arange(200))
    assert int((step.children < 200).sum()) == 200


@pytest.mark.parametrize("block_voxels", [7, 64, 10_000])
def test_pair_blocks_hold_each_neighbour_once(block_voxels: int) -> None:
    """The set of (offset, source, target) is that of the table; padding is in no list."""
    table = neighbours(some_voxels(150, seed=3), 3)
    found = []
    for block in pair_blocks(table, block_voxels=block_voxels):
        listed = block.by_target.order.tolist()
        assert len(listed) == sum(block.counts)
        first = 0
        for offset, (count, length) in enumerate(zip(block.counts, block.lengths, strict=True)):
            span = range(first, first + count)
            assert set(span) <= set(listed)
            found += [(offset, int(block.source[p]), int(block.target[p])) for p in span]
            first += length
    row, offset = (table < len(table)).nonzero(as_tuple=True)
    expected = zip(offset.tolist(), table[row, offset].tolist(), row.tolist(), strict=True)
    assert sorted(found) == sorted(expected)


def test_padded_lengths_are_few_and_near() -> None:
    """At least the count; at most a quarter or 15 more; four sizes per octave; 0 stays 0."""
    lengths = [padded(count) for count in range(5000)]
    assert lengths[0] == 0
    assert all(c <= n <= max(1.25 * c, c + 15) for c, n in enumerate(lengths))
    assert len(set(lengths)) < 40


def test_levels_with_few_voxels_may_gather() -> None:
    """`pairs_from` decides level by level; `GATHER` makes no pairs at all."""
    voxels = as_voxels(some_voxels(300, seed=4))
    fewest = (301, 1, 10**9, 1, 0)
    maps = kernel_maps(voxels, pairs_from=fewest)
    assert maps.counts[0] == 300
    assert [bool(level.blocks) for level in maps.levels] == [False, True, False, True, True]
    assert not any(level.blocks for level in kernel_maps(voxels, kernel=Kernel.GATHER).levels)
    assert not maps.stem.blocks
