"""Dense twins of the sparse operations: the whole box of voxels, zeros where there is nothing.

They share no code with the sparse ones but the coordinates, and PyTorch differentiates them. For
tests: a skin of 25,000 points fills a fiftieth of its box.
"""

from __future__ import annotations

from torch import Tensor
from torch.nn.functional import conv3d, conv_transpose3d


def to_dense(values: Tensor, cells: Tensor, size: int) -> Tensor:
    """Sparse values (N, B, C) at cells (N, 3) as a dense grid, shape (B, C, size, size, size)."""
    grid = values.new_zeros(size, size, size, *values.shape[1:])
    grid = grid.index_put((cells[:, 0], cells[:, 1], cells[:, 2]), values)
    return grid.permute(3, 4, 0, 1, 2)


def at_cells(grid: Tensor, cells: Tensor) -> Tensor:
    """Values (N, B, C) of a dense grid (B, C, X, Y, Z) at cells (N, 3)."""
    return grid[:, :, cells[:, 0], cells[:, 1], cells[:, 2]].permute(2, 0, 1)


def dense_convolve(grid: Tensor, weight: Tensor) -> Tensor:
    """Convolution of an odd kernel, weight (K, C, D) with z fastest among its offsets."""
    edge = round(weight.shape[0] ** (1 / 3))
    kernel = weight.view(edge, edge, edge, *weight.shape[1:]).permute(4, 3, 0, 1, 2)
    return conv3d(grid, kernel, padding=edge // 2)


def dense_down(grid: Tensor, weight: Tensor) -> Tensor:
    """Kernel 2, stride 2, weight (8, C, D)."""
    return conv3d(grid, weight.view(2, 2, 2, *weight.shape[1:]).permute(4, 3, 0, 1, 2), stride=2)


def dense_up(grid: Tensor, weight: Tensor) -> Tensor:
    """The transpose: kernel 2, stride 2, weight (8, C, D)."""
    kernel = weight.view(2, 2, 2, *weight.shape[1:]).permute(3, 4, 0, 1, 2)
    return conv_transpose3d(grid, kernel, stride=2)
