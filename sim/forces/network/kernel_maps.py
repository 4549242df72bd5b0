"""All that a network looks up about a membrane: built once, kept by the caller, used every frame.

A convolution has two equal ways. `GATHER` copies the neighbours of each voxel side by side, holes
as zeros, and multiplies once: few launches, which suits a GPU. `PAIRS` multiplies the existing
pairs alone, one product per offset, then sums per voxel: on a skin three of four neighbours do not
exist, so a CPU saves as much work. Its pairs come in blocks of voxels that lie near each other, so
that what one step writes is still in the cache when the next reads it.

Measured on one core of a CPU, the published network at 25,000 points: in float32 `PAIRS` 0.45 s
(0.63 s in one block); in bfloat16 `GATHER` 0.24 s, `PAIRS` 0.14 s. At 1,000 points in bfloat16 the
many small products of `PAIRS` cost more than they save (14 against 12 ms, the small network 10
against 4.5): levels with few voxels may gather.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from enum import StrEnum

import torch
from torch import Tensor

from sim.forces.network.levels import Step, coarser, neighbours
from sim.forces.network.segments import Segments, segments
from sim.forces.network.spec import DEPTH
from sim.forces.network.voxels import Voxels

BLOCK_VOXELS = 2048
"""Voxels of a block of pairs on a CPU."""
SMALLEST_SPAN = 16
BLOCK_EDGE = 3
"""Edge of the kernels within blocks of the network; every level has maps for it."""


class Kernel(StrEnum):
    """How a convolution is computed."""

    GATHER = "gather"
    PAIRS = "pairs"


def kernel_on(device: str) -> Kernel:
    """How convolutions in float32 are computed on a device."""
    return Kernel.PAIRS if device == "cpu" else Kernel.GATHER


@dataclass(frozen=True, kw_only=True, slots=True)
class PairBlock:
    """The pairs of neighbours that end in some successive voxels, by offset."""

    first: int
    """First of the voxels."""
    source: Tensor
    """Voxel at the offset, shape (P,), int64. Spans of offsets are padded with voxel 0."""
    target: Tensor
    """Voxel that it adds to, shape (P,), int64."""
    counts: tuple[int, ...]
    """Pairs of each offset, padding left out."""
    lengths: tuple[int, ...]
    """Length of each offset's span, padding counted in: a size of `padded`."""
    by_target: Segments
    """The pairs of each voxel of the block; padding belongs to none."""

    def to(self, device: str | torch.device) -> PairBlock:
        """The same on another device."""
        return PairBlock(
            first=self.first,
            source=self.source.to(device),
            target=self.target.to(device),
            counts=self.counts,
            lengths=self.lengths,
            by_target=self.by_target.to(device),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Table:
    """The neighbours of one level for one kernel."""

    neighbours: Tensor
    """Voxel at each offset, N where there is none, shape (N, K), int64."""
    blocks: tuple[PairBlock, ...] = ()
    """The same as pairs; empty where a convolution shall gather."""

    def to(self, device: str | torch.device) -> Table:
        """The same on another device."""
        return Table(
            neighbours=self.neighbours.to(device),
            blocks=tuple(block.to(device) for block in self.blocks),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class KernelMaps:
    """All maps of one membrane, or of a batch of several."""

    stem: Table
    """Of the stem's kernel at the finest level."""
    levels: tuple[Table, ...]
    """Of the 3 x 3 x 3 kernel at each level, finest first."""
    steps: tuple[Step, ...]
    """From each level to the next coarser one."""

    @property
    def counts(self) -> tuple[int, ...]:
        """Voxels of each level."""
        return tuple(len(level.neighbours) for level in self.levels)

    def to(self, device: str | torch.device) -> KernelMaps:
        """The same on another device."""
        return KernelMaps(
            stem=self.stem.to(device),
            levels=tuple(level.to(device) for level in self.levels),
            steps=tuple(step.to(device) for step in self.steps),
        )


def kernel_maps(
    voxels: Voxels,
    *,
    stem_edge: int = 5,
    kernel: Kernel = Kernel.PAIRS,
    block_voxels: int | None = None,
    pairs_from: Sequence[int] = (0,) * (DEPTH + 1),
) -> KernelMaps:
    """The maps of these voxels, on the device where they are.

    Args:
        voxels: Of one membrane, or joined from several.
        stem_edge: Edge of the stem's kernel, as `NetworkSpec` says.
        kernel: How convolutions inside the network are computed. The stem has few channels and many
            offsets: it always gathers.
        block_voxels: Voxels of a block of pairs; None: `BLOCK_VOXELS` on a CPU, all of them on a
            GPU, where few launches matter more than a cache.
        pairs_from: Fewest voxels of each level, finest first, with which it uses pairs; with fewer
            it gathers, whatever `kernel` says.
    """
    if block_voxels is None:
        block_voxels = BLOCK_VOXELS if voxels.coordinates.device.type == "cpu" else voxels.count

    def table(coordinates: Tensor, fewest: int) -> Table:
        found = neighbours(coordinates, BLOCK_EDGE)
        if kernel is Kernel.GATHER or len(found) < fewest:
            return Table(neighbours=found)
        return Table(neighbours=found, blocks=pair_blocks(found, block_voxels=block_voxels))

    coordinates = voxels.coordinates
    stem = Table(neighbours=neighbours(coordinates, stem_edge))
    levels, steps = [table(coordinates, pairs_from[0])], []
    for fewest in pairs_from[1:]:
        coordinates, step = coarser(coordinates)
        steps.append(step)
        levels.append(table(coordinates, fewest))
    return KernelMaps(stem=stem, levels=tuple(levels), steps=tuple(steps))


def pair_blocks(table: Tensor, *, block_voxels: int) -> tuple[PairBlock, ...]:
    """The existing pairs of a table of neighbours (N, K), in blocks of voxels."""
    return tuple(
        _pair_block(table, first, min(first + block_voxels, len(table)))
        for first in range(0, len(table), block_voxels)
    )


def padded(count: int) -> int:
    """The count, rounded up to one of four sizes per octave; 0 stays 0.

    oneDNN prepares a program for each shape of a product in bfloat16 and keeps 1,024 of them: with
    as many shapes as there are spans, it would prepare anew at every frame (787 in place of 130
    ms).
    """
    grain = max(SMALLEST_SPAN, 1 << max(count.bit_length() - 3, 0))
    return -(-count // grain) * grain


def _pair_block(table: Tensor, first: int, end: int) -> PairBlock:
    block = table[first:end]
    offset, row = (block.t() != len(table)).nonzero(as_tuple=True)
    counts = torch.bincount(offset, minlength=table.shape[1]).tolist()
    lengths = [padded(count) for count in counts]
    # How far padding has moved the pairs of each offset.
    moved = torch.tensor(lengths).cumsum(0) - torch.tensor(counts).cumsum(0)
    moved = torch.cat([moved.new_zeros(1), moved[:-1]]).to(table.device)
    place = torch.arange(len(row), device=table.device) + moved[offset]
    source = table.new_zeros(sum(lengths))
    target = table.new_zeros(sum(lengths))
    source[place], target[place] = block[row, offset], row + first
    lists = segments(row, count=end - first)
    return PairBlock(
        first=first,
        source=source,
        target=target,
        counts=tuple(counts),
        lengths=tuple(lengths),
        by_target=Segments(order=place[lists.order], starts=lists.starts),
    )
