"""The layers of the network: sparse convolutions that know their level, and the residual block.

Rows hold voxels first, then samples (`products`). Under PyTorch's autocast the operands of a
convolution take its type, as those of a linear layer do.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor, nn
from torch.nn import functional

from sim.forces.network.convolution import convolve
from sim.forces.network.kernel_maps import BLOCK_EDGE, KernelMaps, Table
from sim.forces.network.levels import OCTANTS
from sim.forces.network.spec import Activation
from sim.forces.network.strided import down, up


class _Convolution(nn.Module):
    """Weight and optional bias; drawn as MinkowskiEngine's residual networks draw them.

    Normal with variance 2 / (outputs x offsets). Source: K. He et al., "Delving Deep into
    Rectifiers", ICCV 2015, equation 14 (fan-out).
    """

    bias: nn.Parameter | None
    """Of the outputs; None in training, where a normalisation follows or nothing needs it."""

    def __init__(self, channels: int, planes: int, *, offsets: int, level: int) -> None:
        super().__init__()
        self.level = level
        self.weight = nn.Parameter(torch.empty(offsets, channels, planes))
        self.register_parameter("bias", None)
        nn.init.normal_(self.weight, std=math.sqrt(2.0 / (planes * offsets)))

    def operands(self, rows: Tensor) -> tuple[Tensor, Tensor]:
        """Rows and weight in the type in which they are multiplied."""
        kind = rows.device.type
        if torch.is_autocast_enabled(kind):
            dtype = torch.get_autocast_dtype(kind)
            return rows.to(dtype), self.weight.to(dtype)
        return rows, self.weight

    def shifted(self, products: Tensor) -> Tensor:
        """The products plus the bias, where there is one."""
        if self.bias is None:
            return products
        return products + self.bias if torch.is_grad_enabled() else products.add_(self.bias)


class Convolution(_Convolution):
    """Submanifold convolution 3 x 3 x 3 at one level."""

    def __init__(self, channels: int, planes: int, *, level: int, edge: int = BLOCK_EDGE) -> None:
        super().__init__(channels, planes, offsets=edge**3, level=level)

    def table(self, maps: KernelMaps) -> Table:
        """The neighbours that this layer looks at."""
        return maps.levels[self.level]

    def forward(self, rows: Tensor, maps: KernelMaps, samples: int) -> Tensor:
        rows, weight = self.operands(rows)
        return self.shifted(convolve(rows, self.table(maps), weight, samples=samples))


class Stem(Convolution):
    """The first convolution: at the finest level, with a kernel of its own."""

    def __init__(self, channels: int, planes: int, *, edge: int) -> None:
        super().__init__(channels, planes, level=0, edge=edge)

    def table(self, maps: KernelMaps) -> Table:
        return maps.stem


class Down(_Convolution):
    """From level `level` to the next coarser one."""

    def __init__(self, channels: int, planes: int, *, level: int) -> None:
        super().__init__(channels, planes, offsets=OCTANTS, level=level)

    def forward(self, rows: Tensor, maps: KernelMaps, samples: int) -> Tensor:
        rows, weight = self.operands(rows)
        return self.shifted(down(rows, maps.steps[self.level], weight, samples=samples))


class Up(Down):
    """From the level below `level` back to it."""

    def forward(self, rows: Tensor, maps: KernelMaps, samples: int) -> Tensor:
        rows, weight = self.operands(rows)
        return self.shifted(up(rows, maps.steps[self.level], weight, samples=samples))


class BatchNorm(nn.BatchNorm1d):
    """Batch normalisation; one row alone, which has no variance, is taken as in use.

    A small patch by itself is one voxel at the coarsest level.
    """

    def forward(self, input: Tensor) -> Tensor:
        """Rows of one level, shape (N, C), shifted and scaled."""
        if self.training and len(input) == 1:
            return functional.batch_norm(
                input, self.running_mean, self.running_var, self.weight, self.bias, eps=self.eps
            )
        return super().forward(input)


def norm(planes: int, *, there: bool) -> nn.Module:
    """Batch normalisation over all voxels and samples, or nothing."""
    return BatchNorm(planes) if there else nn.Identity()


def activated(rows: Tensor, activation: Activation) -> Tensor:
    """ReLU, or its leaky form; in place where no gradient will need the input."""
    inplace = not torch.is_grad_enabled()
    if activation is Activation.LEAKY:
        return functional.leaky_relu(rows, inplace=inplace)
    return functional.relu(rows, inplace=inplace)


class Block(nn.Module):
    """Two 3 x 3 x 3 convolutions and a way around them."""

    def __init__(self, channels: int, planes: int, *, level: int, normed: bool) -> None:
        super().__init__()
        self.first = Convolution(channels, planes, level=level)
        self.first_norm = norm(planes, there=normed)
        self.second = Convolution(planes, planes, level=level)
        self.second_norm = norm(planes, there=normed)
        self.around: nn.Linear | None = None
        self.around_norm: nn.Module = nn.Identity()
        if channels != planes:
            self.around = nn.Linear(channels, planes, bias=False)
            self.around_norm = norm(planes, there=normed)

    def forward(self, rows: Tensor, maps: KernelMaps, samples: int) -> Tensor:
        around = rows if self.around is None else self.around_norm(self.around(rows))
        inner = self.first_norm(self.first(rows, maps, samples))
        inner = activated(inner, Activation.RELU)
        inner = self.second_norm(self.second(inner, maps, samples))
        return activated(inner + around, Activation.RELU)
