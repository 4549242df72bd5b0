"""Down and up one level: the convolution of kernel 2 and stride 2, and its transpose.

Down: y_p = sum over octants o of x_child(p,o) W_o, over the children that exist. Up: y_c =
x_parent(c) W_octant(c), at the voxels that the finer level had. Each is the other's gradient by its
input, so both gather and neither scatters.
"""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from sim.forces.network.levels import OCTANTS, Step
from sim.forces.network.products import gather_gradient, gather_product


def down(rows: Tensor, step: Step, weight: Tensor, *, samples: int = 1) -> Tensor:
    """Features of the coarser level, shape (M B, D) from (N B, C); weight (8, C, D)."""
    if not torch.is_grad_enabled():
        return gather_product(rows, step.children, weight, samples=samples)
    return _Down.apply(rows, weight, step, samples)


def up(rows: Tensor, step: Step, weight: Tensor, *, samples: int = 1) -> Tensor:
    """Features of the finer level, shape (N B, D) from (M B, C); weight (8, C, D)."""
    if not torch.is_grad_enabled():
        return _spread(rows, step, weight, samples)
    return _Up.apply(rows, weight, step, samples)


def _spread(rows: Tensor, step: Step, weight: Tensor, samples: int) -> Tensor:
    """All eight products of each coarse row, of which each fine voxel takes one."""
    channels, planes = weight.shape[1:]
    wide = rows @ weight.permute(1, 0, 2).reshape(channels, OCTANTS * planes)
    sample = torch.arange(samples, device=rows.device)[None]
    row = (step.parent[:, None] * samples + sample) * OCTANTS + step.octant[:, None]
    return wide.view(-1, planes).index_select(0, row.reshape(-1))


def _spread_gradient(rows: Tensor, step: Step, gradient: Tensor, samples: int) -> Tensor:
    """Gradient of `_spread` by its weight: that of `down`, with the two sides exchanged."""
    return gather_gradient(gradient, step.children, rows, samples=samples).transpose(1, 2)


class _Down(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, rows: Tensor, weight: Tensor, step: Step, samples: int) -> Tensor:
        ctx.save_for_backward(rows, weight)
        ctx.step, ctx.samples = step, samples
        return gather_product(rows, step.children, weight, samples=samples)

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, Tensor | None, None, None]:
        rows, weight = ctx.saved_tensors
        step, samples, gradient = ctx.step, ctx.samples, gradients[0].contiguous()
        by_rows = by_weight = None
        if ctx.needs_input_grad[0]:
            by_rows = _spread(gradient, step, weight.transpose(1, 2), samples)
        if ctx.needs_input_grad[1]:
            by_weight = gather_gradient(rows, step.children, gradient, samples=samples)
        return by_rows, by_weight, None, None


class _Up(torch.autograd.Function):
    @staticmethod
    def forward(ctx: Any, rows: Tensor, weight: Tensor, step: Step, samples: int) -> Tensor:
        ctx.save_for_backward(rows, weight)
        ctx.step, ctx.samples = step, samples
        return _spread(rows, step, weight, samples)

    @staticmethod
    def backward(ctx: Any, *gradients: Tensor) -> tuple[Tensor | None, Tensor | None, None, None]:
        rows, weight = ctx.saved_tensors
        step, samples, gradient = ctx.step, ctx.samples, gradients[0].contiguous()
        by_rows = by_weight = None
        if ctx.needs_input_grad[0]:
            turned = weight.transpose(1, 2)
            by_rows = gather_product(gradient, step.children, turned, samples=samples)
        if ctx.needs_input_grad[1]:
            by_weight = _spread_gradient(rows, step, gradient, samples)
        return by_rows, by_weight, None, None
