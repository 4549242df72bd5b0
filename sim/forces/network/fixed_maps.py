"""Kernel maps in tables of a fixed length: what a recorded computation builds anew at each frame.

`kernel_maps` asks how many voxels there are before it makes a table of them; each such question
makes a GPU wait for the host, and no CUDA graph can hold one. Here every table has room for so many
rows, the rows in use come first, and what did not find room is counted: the caller then asks again
with more. Neighbours, children and parents of the rows in use are those of `kernel_maps`; of free
rows nothing is said but that no row in use looks at them.

The strides of the keys are those of the largest box, and the same at every level, since coarser
voxels have smaller numbers. All offsets are searched: the half that follows by symmetry would have
to be told from holes.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import torch
from torch import Tensor

from sim.forces.network.kernel_maps import BLOCK_EDGE, KernelMaps, Table
from sim.forces.network.levels import MARGIN, OCTANTS, Step, offsets
from sim.forces.network.segments import Segments


class Lattice:
    """How voxels of some membranes become keys, sorted as (membrane, x, y, z).

    Attributes:
        free: Key of a row that is not in use; larger than all others.
    """

    def __init__(
        self, size: Sequence[int], *, membranes: int, stem_edge: int, device: str | torch.device
    ) -> None:
        """Prepare keys.

        Args:
            size: Most voxels along x, y and z; cells are numbered from 0.
            membranes: How many.
            stem_edge: Edge of the stem's kernel, as `NetworkSpec` says.
            device: Where the keys are.
        """
        _, wide_y, wide_z = wide = [count + 2 * MARGIN for count in size]
        self._strides = (wide[0] * wide_y * wide_z, wide_y * wide_z, wide_z)
        self.free = 2 * membranes * self._strides[0]
        self.stem_steps = self._steps(stem_edge, device)
        self.level_steps = self._steps(BLOCK_EDGE, device)

    def keys(self, membrane: Tensor, cells: Tensor) -> Tensor:
        """Keys (...,), int64, of cells (..., 3) of membranes (...,)."""
        x, y, z = (cells + MARGIN).unbind(-1)
        by_membrane, by_x, by_y = self._strides
        return membrane * by_membrane + x * by_x + y * by_y + z

    def halved(self, keys: Tensor) -> tuple[Tensor, Tensor]:
        """Keys of the cells of twice the edge, and the octant of each cell in its own."""
        by_membrane, by_x, by_y = self._strides
        membrane, rest = keys // by_membrane, keys % by_membrane
        x, y, z = rest // by_x, rest % by_x // by_y, rest % by_y
        cells = torch.stack([x, y, z], dim=-1) - MARGIN
        bits = cells & 1
        octant = bits[:, 0] * 4 + bits[:, 1] * 2 + bits[:, 2]
        coarse = self.keys(membrane, cells >> 1)
        return torch.where(keys < self.free, coarse, self.free), octant

    def _steps(self, edge: int, device: str | torch.device) -> Tensor:
        """What the offsets of a kernel add to a key, shape (edge^3,)."""
        x, y, z = offsets(edge, device=torch.device(device)).unbind(-1)
        return x * self._strides[1] + y * self._strides[2] + z


@dataclass(frozen=True, kw_only=True, slots=True)
class Distinct:
    """The different ones among some keys, in a table with room for so many."""

    keys: Tensor
    """Sorted, the free ones last, shape (N,)."""
    of_row: Tensor
    """Place of each given key, N where it is free or found no room, shape (R,)."""
    rows: Segments
    """The given rows of each place; none of a free one."""
    count: Tensor
    """How many there are, room or not: a number."""


def distinct(keys: Tensor, *, room: int, free: int) -> Distinct:
    """The different keys of (R,), of which `free` and larger ones are none."""
    ordered, order = torch.sort(keys, stable=True)
    there = ordered < free
    first = there.clone()
    first[1:] &= ordered[1:] != ordered[:-1]
    number = torch.where(there, first.cumsum(0) - 1, room).clamp(max=room)
    # What has no place of its own goes to one behind the table, which is cut off.
    table = keys.new_full((room + 1,), free)
    table.scatter_(0, torch.where(first, number, room), ordered)
    places = torch.arange(room + 1, device=keys.device)
    return Distinct(
        keys=table[:room],
        of_row=torch.empty_like(order).scatter_(0, order, number),
        rows=Segments(order=order, starts=torch.searchsorted(number, places)),
        count=first.sum(),
    )


def fixed_maps(
    keys: Tensor, lattice: Lattice, *, rooms: Sequence[int]
) -> tuple[KernelMaps, list[Tensor]]:
    """Maps that gather, and how many voxels each coarser level has, room or not.

    Args:
        keys: Of the finest voxels, distinct and sorted, the free ones last, shape (N,).
        lattice: Of the keys.
        rooms: Rows for each coarser level, finest first.
    """
    stem = Table(neighbours=_neighbours(keys, lattice.stem_steps, lattice.free))
    levels = [Table(neighbours=_neighbours(keys, lattice.level_steps, lattice.free))]
    steps, counts = [], []
    for room in rooms:
        keys, step, count = _coarser(keys, lattice, room)
        levels.append(Table(neighbours=_neighbours(keys, lattice.level_steps, lattice.free)))
        steps.append(step)
        counts.append(count)
    return KernelMaps(stem=stem, levels=tuple(levels), steps=tuple(steps)), counts


def _neighbours(keys: Tensor, steps: Tensor, free: int) -> Tensor:
    """Row at each offset, N where there is none, shape (N, K)."""
    room = len(keys)
    wanted = keys[:, None] + steps
    found = torch.searchsorted(keys, wanted).clamp_(max=room - 1)
    there = (keys[found] == wanted) & (keys < free)[:, None]
    return torch.where(there, found, room)


def _coarser(keys: Tensor, lattice: Lattice, room: int) -> tuple[Tensor, Step, Tensor]:
    """Keys of the next coarser level, how these rows make them up, and how many there are."""
    halves, octant = lattice.halved(keys)
    found = distinct(halves, room=room, free=lattice.free)
    fine = torch.arange(len(keys), device=keys.device)
    children = keys.new_full(((room + 1) * OCTANTS,), len(keys))
    children.scatter_(0, found.of_row * OCTANTS + octant, fine)
    step = Step(
        children=children.view(-1, OCTANTS)[:room],
        parent=found.of_row.clamp(max=room - 1),
        octant=octant,
    )
    return found.keys, step, found.count
