"""How far the sparse operations are from dense ones, on a membrane: what validation prints."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.convolution import convolve
from sim.forces.network.kernel_maps import Kernel, kernel_maps
from sim.forces.network.levels import Step
from sim.forces.network.reference import at_cells, dense_convolve, dense_down, dense_up, to_dense
from sim.forces.network.strided import down, up
from sim.forces.network.voxels import voxel_edge_mm, voxelise

CHANNELS, PLANES, SAMPLES = 8, 6, 2


def sparse_dense_difference(
    points_mm: np.ndarray, *, double: bool, own_voxel_only: bool = False
) -> float:
    """Largest difference of every kind of sparse convolution from its dense twin.

    The stem's kernel of 5 and kernels of 3, as pairs and gathered, and one step down and up: each
    over the largest value of its dense twin.

    Args:
        points_mm: Points of a membrane [mm], shape (P, 3).
        double: In float64, else in float32.
        own_voxel_only: Instead, what a convolution that looks at no neighbour would score.
    """
    kind = torch.float64 if double else torch.float32
    voxels = voxelise(points_mm, voxel_mm=voxel_edge_mm(points_mm))
    cells = voxels.coordinates[:, 1:]
    # Even, so that a step of two halves it.
    size = 2 * (int(cells.max()) // 2 + 1)
    generator = torch.Generator().manual_seed(3)

    def drawn(*shape: int) -> Tensor:
        return torch.randn(*shape, generator=generator, dtype=torch.float64).to(kind)

    rows = drawn(len(cells) * SAMPLES, CHANNELS)
    grid = to_dense(rows.view(len(cells), SAMPLES, CHANNELS), cells, size)
    worst = 0.0
    with torch.no_grad():
        for kernel in Kernel:
            maps = kernel_maps(voxels, kernel=kernel)
            for table, edge in ((maps.stem, 5), (maps.levels[0], 3)):
                weight = drawn(edge**3, CHANNELS, PLANES)
                dense = at_cells(dense_convolve(grid, weight), cells).reshape(-1, PLANES)
                found = convolve(rows, table, weight, samples=SAMPLES)
                if own_voxel_only:
                    found = rows @ weight[edge**3 // 2]
                worst = max(worst, _relative(found, dense))
            worst = max(worst, *_step_differences(rows, grid, cells, maps.steps[0], drawn))
    return worst


def _step_differences(
    rows: Tensor, grid: Tensor, cells: Tensor, step: Step, drawn: Callable[..., Tensor]
) -> list[float]:
    """Of one step down and one up again."""
    weight, back = drawn(8, CHANNELS, PLANES), drawn(8, PLANES, CHANNELS)
    coarse_cells = torch.unique(cells // 2, dim=0)
    dense = dense_down(grid, weight)
    found = down(rows, step, weight, samples=SAMPLES)
    expected = at_cells(dense, coarse_cells).reshape(-1, PLANES)
    # Above, a voxel without any child is zero on both sides.
    raised = at_cells(dense_up(dense, back), cells).reshape(-1, CHANNELS)
    return [
        _relative(found, expected),
        _relative(up(found, step, back, samples=SAMPLES), raised),
    ]


def _relative(found: Tensor, expected: Tensor) -> float:
    return float((found - expected).abs().max() / expected.abs().max())
