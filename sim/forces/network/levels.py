"""Voxels of one level: sorted keys, neighbours found by bisection, and the next coarser level.

A voxel (b, x, y, z) has the key ((b Sx + x) Sy + y) Sz + z, with a margin around the occupied box
so that the key of a neighbour is the key plus a constant. Keys are sorted, hence neighbours are
found by bisection; there is no hash table, and the same code runs on a CPU and on a GPU. A kernel
is symmetric, so half of its offsets are searched: if j lies at offset k of i, then i lies at offset
K - 1 - k of j. Coarser coordinates are floor(c / 2), as in MinkowskiEngine.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor

MARGIN = 4
"""Free voxels around the box; at least the reach of a kernel."""
OCTANTS = 8


@dataclass(frozen=True, kw_only=True, slots=True)
class Step:
    """Which voxels of a level make up those of the next coarser one."""

    children: Tensor
    """Fine voxel in each octant of a coarse one, N where there is none, shape (M, 8), int64."""
    parent: Tensor
    """Coarse voxel of each fine one, shape (N,), int64."""
    octant: Tensor
    """4 x + 2 y + z of the place of each fine voxel in its parent, shape (N,), int64."""

    def to(self, device: str | torch.device) -> Step:
        """The same on another device."""
        return Step(
            children=self.children.to(device),
            parent=self.parent.to(device),
            octant=self.octant.to(device),
        )


def _key_strides(coordinates: Tensor) -> tuple[Tensor, Tensor]:
    """Lower corner less the margin, and what a step along b, x, y, z adds to a key."""
    low = coordinates[:, 1:].amin(0) - MARGIN
    size = coordinates[:, 1:].amax(0) - low + 1 + MARGIN
    one = torch.ones_like(size[0])
    return low, torch.stack([size.prod(), size[1] * size[2], size[2], one])


def keys(coordinates: Tensor) -> Tensor:
    """Keys of voxels (N, 4), shape (N,), int64: they sort as the coordinates do."""
    low, strides = _key_strides(coordinates)
    return coordinates[:, 0] * strides[0] + ((coordinates[:, 1:] - low) * strides[1:]).sum(1)


def offsets(edge: int, *, device: torch.device | None = None) -> Tensor:
    """Offsets of an odd kernel, shape (edge^3, 3), z fastest; the middle row is zero."""
    reach = torch.arange(edge, device=device) - edge // 2
    return torch.cartesian_prod(reach, reach, reach)


def neighbours(coordinates: Tensor, edge: int) -> Tensor:
    """Voxel at each offset of a kernel, N where there is none, shape (N, edge^3), int64.

    Args:
        coordinates: Membrane, x, y, z, shape (N, 4), int64, unique and sorted.
        edge: Edge of the kernel, odd and at most 2 MARGIN + 1.
    """
    count, half = len(coordinates), edge**3 // 2
    key = keys(coordinates)
    _, strides = _key_strides(coordinates)
    steps = (offsets(edge, device=key.device) * strides[1:]).sum(1)[:half]
    wanted = key[:, None] + steps[None]
    found = torch.searchsorted(key, wanted).clamp_(max=count - 1)
    there = key[found] == wanted
    table = torch.full((count, edge**3), count, dtype=torch.int64, device=key.device)
    table[:, :half] = torch.where(there, found, count)
    table[:, half] = torch.arange(count, device=key.device)
    row, offset = there.nonzero(as_tuple=True)
    table[found[row, offset], edge**3 - 1 - offset] = row
    return table


def coarser(coordinates: Tensor) -> tuple[Tensor, Step]:
    """The voxels of twice the edge, sorted, and how these make them up."""
    count, device = len(coordinates), coordinates.device
    halved = coordinates.clone()
    halved[:, 1:] = torch.div(coordinates[:, 1:], 2, rounding_mode="floor")
    bits = coordinates[:, 1:] - 2 * halved[:, 1:]
    octant = bits[:, 0] * 4 + bits[:, 1] * 2 + bits[:, 2]
    coarse_keys, parent = torch.unique(keys(halved), return_inverse=True)
    fine = torch.arange(count, device=device)
    children = torch.full((len(coarse_keys), OCTANTS), count, dtype=torch.int64, device=device)
    children[parent, octant] = fine
    # Any child tells where its parent is; the one of the lowest number is the same at every run.
    first = torch.where(children < count, children, count).amin(1)
    return halved[first], Step(children=children, parent=parent, octant=octant)
