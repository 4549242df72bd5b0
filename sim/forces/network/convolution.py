"""The submanifold convolution and its gradient: outputs only where there are inputs.

y_i = sum_k x_n(i,k) W_k over the neighbours n(i, k) that exist. Kernels are symmetric, so the
gradient by x is the same convolution of the gradient by y with the offsets reversed and each matrix
transposed: the tables serve both ways and nothing is scattered.

Source: B. Graham, M. Engelcke, L. van der Maaten, "3D Semantic Segmentation with Submanifold Sparse
Convolutional Networks", CVPR 2018.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from sim.forces.network.kernel_maps import Table
from sim.forces.network.products import (
    gather_gradient,
    gather_product,
    pairs_gradient,
    pairs_product,
)


def convolve(rows: Tensor, table: Table, weight: Tensor, *, samples: int = 1) -> Tensor:
    """Submanifold convolution, shape (N B, D); differentiable.

    Args:
        rows: Features, row v B + b for voxel v of sample b, shape (N B, C).
        table: Neighbours; they are multiplied as pairs where it has pairs.
        weight: A matrix for each offset, shape (K, C, D).
        samples: B.
    """
    if not torch.is_grad_enabled():
        return _product(rows, table, weight, samples)
    return _Convolution.apply(rows, weight, table, samples)


def _product(rows: Tensor, table: Table, weight: Tensor, samples: int) -> Tensor:
    if table.blocks:
        return pairs_product(rows, table.blocks, weight, samples=samples)
    return gather_product(rows, table.neighbours, weight, samples=samples)


class _Convolution(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, rows: Tensor, weight: Tensor, table: Table, samples: int) -> Tensor:
        ctx.save_for_backward(rows, weight)
        ctx.table, ctx.samples = table, samples
        return _product(rows, table, weight, samples)

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, Tensor | None, None, None]:
        rows, weight = ctx.saved_tensors
        table, samples = ctx.table, ctx.samples
        gradient = gradients[0].contiguous()
        by_rows = by_weight = None
        if ctx.needs_input_grad[0]:
            reversed_weight = weight.flip(0).transpose(1, 2).contiguous()
            by_rows = _product(gradient, table, reversed_weight, samples)
        if ctx.needs_input_grad[1] and table.blocks:
            by_weight = pairs_gradient(rows, table.blocks, gradient, samples=samples)
        elif ctx.needs_input_grad[1]:
            by_weight = gather_gradient(rows, table.neighbours, gradient, samples=samples)
        return by_rows, by_weight, None, None
