"""Batch normalisation folded into the convolution before it, for use after training.

In use a normalisation is y = g (x - m) / sqrt(v + e) + b per channel, so (x W) becomes
x (W s) + (b - m s) with s = g / sqrt(v + e): equal but for rounding, and one pass over memory less.
"""

from __future__ import annotations

import copy

import torch
from torch import Tensor, nn

from sim.forces.network.layers import Block
from sim.forces.network.minkunet import MinkUNet


def folded(network: MinkUNet) -> MinkUNet:
    """A copy of a network for use, without normalisation layers; the network stays as it is."""
    result = copy.deepcopy(network).eval().requires_grad_(False)
    result.stem_norm = _fold(result.stem, result.stem_norm)
    for steps, norms in ((result.downs, result.down_norms), (result.ups, result.up_norms)):
        for number, step in enumerate(steps):
            norms[number] = _fold(step, norms[number])
    for block in (*result.encoder, *result.decoder):
        assert isinstance(block, Block)
        block.first_norm = _fold(block.first, block.first_norm)
        block.second_norm = _fold(block.second, block.second_norm)
        if block.around is not None:
            block.around_norm = _fold(block.around, block.around_norm)
    return result


def _fold(product: nn.Module, norm: nn.Module) -> nn.Module:
    """Change the weights of a convolution or linear layer; what then stands for the norm."""
    if not isinstance(norm, nn.BatchNorm1d):
        return norm
    scale, shift = _scale_and_shift(norm)
    weight = product.get_parameter("weight")
    # A convolution keeps its outputs in the last axis, a linear layer in the first.
    by_output = scale[:, None] if isinstance(product, nn.Linear) else scale
    product.register_parameter("weight", nn.Parameter(weight * by_output, requires_grad=False))
    product.register_parameter("bias", nn.Parameter(shift, requires_grad=False))
    return nn.Identity()


def _scale_and_shift(norm: nn.BatchNorm1d) -> tuple[Tensor, Tensor]:
    mean, variance = norm.running_mean, norm.running_var
    assert mean is not None and variance is not None
    scale = norm.weight.detach() / torch.sqrt(variance + norm.eps)
    return scale, norm.bias.detach() - mean * scale
