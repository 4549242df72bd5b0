"""The network: levels that halve, levels that double, a link between equals; forces add up.

Source of the shape: Ronneberger, Fischer and Brox, U-Net, 2015. Pixels are folded two by two into
channels before the first convolution and unfolded after the last, so that nothing runs at full
resolution. Below, at the coarsest level, each place tells its share of the force and of the
variance of the force; both are sums, as forces of patches of skin are.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import torch
from torch import nn
from torch.nn import functional

from sim.reading.network.spec import INPUTS, LOG_VARIANCE, OUTPUTS, ReaderSpec

FOLD = 2
FORCE_WIDTH = 64
LEAST_VARIANCE = 1e-4
"""Of a scaled force."""
FIRST_WEIGHT, FIRST_LOG = 1e-3, -6.0
"""Spread of the last weights before learning, and what variances begin with [1]."""


class UNet(nn.Module):
    """Images (B, INPUTS, H, W) to maps (B, OUTPUTS, H, W) and forces with log variance (B, 4)."""

    def __init__(self, spec: ReaderSpec, *, normed: bool) -> None:
        """Build it.

        Args:
            spec: Its size.
            normed: With batch normalisation, for training; without, for use, where it is folded
                into the convolutions.
        """
        super().__init__()
        widths = spec.widths
        above = (INPUTS * FOLD**2, *widths[:-1])
        self.down = nn.ModuleList(
            _block(given, width, normed) for given, width in zip(above, widths, strict=True)
        )
        self.up = nn.ModuleList(
            _block(widths[k] + widths[k + 1], widths[k], normed) for k in range(len(widths) - 1)
        )
        self.maps = nn.Conv2d(widths[0], OUTPUTS * FOLD**2, 1)
        self.shares = nn.Sequential(
            nn.Conv2d(widths[-1], FORCE_WIDTH, 1), nn.ReLU(), nn.Conv2d(FORCE_WIDTH, 4, 1)
        )
        if normed:
            self._begin_calm()

    def _begin_calm(self) -> None:
        """Before it learns it says that nothing moved and nothing pushes, and doubts that little.

        Sums over hundreds of places would else begin far off.
        """
        for layer, doubt in (
            (self.maps, slice(LOG_VARIANCE * FOLD**2, None)),
            (self.shares[-1], 3),
        ):
            assert isinstance(layer, nn.Conv2d)
            assert layer.bias is not None
            nn.init.normal_(layer.weight, std=FIRST_WEIGHT)
            nn.init.zeros_(layer.bias)
            with torch.no_grad():
                layer.bias[doubt] = FIRST_LOG

    def forward(self, images: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        """Maps and forces."""
        x = functional.pixel_unshuffle(images, FOLD)
        kept: list[torch.Tensor] = []
        for number, block in enumerate(self.down):
            if number:
                x = functional.max_pool2d(x, 2)
            x = block(x)
            kept.append(x)
        # Sums in full precision, whatever convolutions compute in.
        shares = self.shares(x).float()
        force = shares[:, :3].sum(dim=(2, 3))
        variance = functional.softplus(shares[:, 3:]).sum(dim=(2, 3)) + LEAST_VARIANCE
        for number in range(len(self.up) - 1, -1, -1):
            x = functional.interpolate(x, scale_factor=2.0, mode="nearest")
            x = self.up[number](torch.cat([x, kept[number]], dim=1))
        maps = functional.pixel_shuffle(self.maps(x), FOLD)
        return maps, torch.cat([force, variance.log()], dim=1)


def _block(given: int, width: int, normed: bool) -> nn.Sequential:
    layers: list[nn.Module] = []
    for channels in (given, width):
        layers.append(nn.Conv2d(channels, width, 3, padding=1, bias=not normed))
        if normed:
            layers.append(nn.BatchNorm2d(width))
        layers.append(nn.ReLU())
    return nn.Sequential(*layers)


def folded_state(trained: UNet) -> dict[str, torch.Tensor]:
    """The state of the network without normalisation that computes the same, in float32.

    w' = w g / s,  b' = b - m g / s  with g, b, m, s of the normalisation.
    """
    found: dict[str, torch.Tensor] = {}
    for part in ("down", "up"):
        for number, block in enumerate(getattr(trained, part)):
            layers = list(block)
            pairs = zip(layers[::3], layers[1::3], strict=True)
            for place, (convolution, norm) in enumerate(pairs):
                factor = norm.weight / torch.sqrt(norm.running_var + norm.eps)
                name = f"{part}.{number}.{2 * place}"
                found[f"{name}.weight"] = convolution.weight * factor[:, None, None, None]
                found[f"{name}.bias"] = norm.bias - norm.running_mean * factor
    own = trained.state_dict()
    found.update({name: own[name] for name in own if name.split(".")[0] in ("maps", "shares")})
    return {name: value.detach().float().cpu() for name, value in found.items()}


def channels_last(network: UNet) -> UNet:
    """The same network with weights in the order in which processors convolve fastest."""
    # PyTorch's types leave this form out.
    module: Any = network
    return module.to(memory_format=torch.channels_last)


def network_of(spec: ReaderSpec, state: Mapping[str, torch.Tensor]) -> UNet:
    """A network for use, from its folded state."""
    network = UNet(spec, normed=False)
    network.load_state_dict(dict(state))
    return network.eval()
