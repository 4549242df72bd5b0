"""Gather and multiply: the arithmetic under every sparse convolution, without gradients.

Rows hold voxels first, then samples: with B samples of one membrane, row v B + b is voxel v of
sample b. A table of neighbours says N for a hole; the rows N B to N B + B - 1, appended here, are
zero.
"""

from __future__ import annotations

from collections.abc import Iterator

import torch
from torch import Tensor

from sim.forces.network.kernel_maps import PairBlock
from sim.forces.network.segments import segment_sum

CHUNK_BYTES = {"cpu": 8 << 20, "cuda": 512 << 20}
"""Largest copy of neighbours at a time. On a CPU it should stay in the cache (190 in place of 359
ms for the largest layer at 25,000 points); on a GPU it must leave room for the rest."""


def _with_holes(rows: Tensor, samples: int) -> Tensor:
    return torch.cat([rows, rows.new_zeros(samples, rows.shape[1])])


def _gathered(rows: Tensor, table: Tensor, samples: int) -> Iterator[tuple[slice, Tensor]]:
    """Neighbours side by side, chunk by chunk: rows they belong to, and (R, K C)."""
    count, offsets = table.shape
    width = offsets * rows.shape[1]
    most = CHUNK_BYTES.get(rows.device.type, CHUNK_BYTES["cuda"])
    step = max(1, most // (width * samples * rows.element_size()))
    padded = _with_holes(rows, samples)
    sample = torch.arange(samples, device=rows.device)[None, :, None]
    for first in range(0, count, step):
        part = table[first : first + step]
        if samples > 1:
            part = part[:, None, :] * samples + sample
        chunk = padded.index_select(0, part.reshape(-1)).view(-1, width)
        yield slice(first * samples, first * samples + len(chunk)), chunk


def gather_product(rows: Tensor, table: Tensor, weight: Tensor, *, samples: int) -> Tensor:
    """Sum over offsets k of rows[table[:, k]] @ weight[k], shape (R B, D).

    Args:
        rows: Features, shape (N B, C).
        table: Voxel at each offset, N for a hole, shape (R, K).
        weight: Shape (K, C, D).
        samples: B.
    """
    matrix = weight.reshape(-1, weight.shape[2])
    products = [chunk @ matrix for _, chunk in _gathered(rows, table, samples)]
    return products[0] if len(products) == 1 else torch.cat(products)


def gather_gradient(rows: Tensor, table: Tensor, gradient: Tensor, *, samples: int) -> Tensor:
    """Gradient of `gather_product` by its weight, shape (K, C, D)."""
    channels, planes = rows.shape[1], gradient.shape[1]
    total = rows.new_zeros(table.shape[1] * channels, planes)
    for where, chunk in _gathered(rows, table, samples):
        total += chunk.t() @ gradient[where]
    return total.view(-1, channels, planes)


def _selected(rows: Tensor, voxels: Tensor, samples: int) -> Tensor:
    """All samples of some voxels, shape (P B, C)."""
    wide = rows.view(-1, samples * rows.shape[1])
    return wide.index_select(0, voxels).view(-1, rows.shape[1])


def _spans(block: PairBlock, sizes: tuple[int, ...], samples: int) -> Iterator[tuple[int, slice]]:
    """Each offset that has pairs, and as many of its rows as `sizes` says."""
    first = 0
    for offset, (length, size) in enumerate(zip(block.lengths, sizes, strict=True)):
        if size:
            yield offset, slice(first * samples, (first + size) * samples)
        first += length


def pairs_product(
    rows: Tensor, blocks: tuple[PairBlock, ...], weight: Tensor, *, samples: int
) -> Tensor:
    """What `gather_product` gives for the table that the blocks were made of."""
    planes = weight.shape[2]
    sums = []
    for block in blocks:
        sources = _selected(rows, block.source, samples)
        products = rows.new_empty(len(sources), planes)
        for offset, span in _spans(block, block.lengths, samples):
            torch.mm(sources[span], weight[offset], out=products[span])
        sums.append(segment_sum(products.view(-1, samples * planes), block.by_target))
    return torch.cat(sums).view(-1, planes)


def pairs_gradient(
    rows: Tensor, blocks: tuple[PairBlock, ...], gradient: Tensor, *, samples: int
) -> Tensor:
    """Gradient of `pairs_product` by its weight, shape (K, C, D)."""
    total = rows.new_zeros(len(blocks[0].counts), rows.shape[1], gradient.shape[1])
    for block in blocks:
        sources = _selected(rows, block.source, samples)
        ends = _selected(gradient, block.target, samples)
        for offset, span in _spans(block, block.counts, samples):
            total[offset].addmm_(sources[span].t(), ends[span])
    return total
