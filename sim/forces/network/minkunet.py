"""The network: a sparse U-Net over the voxels of a skin.

A stem, four times down with a block each, four times up with a skip connection and a block each,
and a linear layer per voxel. The encoder is what sees the dent, the decoder what turns it into
numbers: for another stiffness the decoder alone is trained again.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import torch
from torch import Tensor, nn

from sim.forces.network.kernel_maps import KernelMaps
from sim.forces.network.layers import Block, Down, Stem, Up, activated, norm
from sim.forces.network.spec import DEPTH, NetworkSpec, Norm
from sim.forces.network.weights import NetworkWeights
from workbench.core.base.errors import StoreError, shown


class MinkUNet(nn.Module):
    """Features of voxels in, predictions at the same voxels out."""

    def __init__(self, spec: NetworkSpec) -> None:
        super().__init__()
        self.spec = spec
        self.encoder_is_frozen = False
        planes, width = spec.planes, spec.stem_planes
        stem_normed, normed = spec.norm is Norm.ALL, spec.norm is not Norm.NONE
        self.stem = Stem(spec.input_channels, width, edge=spec.stem_edge)
        self.stem_norm = norm(width, there=stem_normed)
        self.downs, self.down_norms, self.encoder = (nn.ModuleList() for _ in range(3))
        self.ups, self.up_norms, self.decoder = (nn.ModuleList() for _ in range(3))
        skips = [width]
        for level in range(DEPTH):
            self.downs.append(Down(width, width, level=level))
            self.down_norms.append(norm(width, there=stem_normed))
            self.encoder.append(Block(width, planes[level], level=level + 1, normed=normed))
            width = planes[level]
            skips.append(width)
        skips.pop()
        for level in reversed(range(DEPTH)):
            out = planes[2 * DEPTH - 1 - level]
            self.ups.append(Up(width, out, level=level))
            self.up_norms.append(norm(out, there=stem_normed))
            self.decoder.append(Block(out + skips.pop(), out, level=level, normed=normed))
            width = out
        self.last = nn.Linear(width, spec.output_channels)

    def forward(self, features: Tensor, maps: KernelMaps) -> Tensor:
        """Predictions at the voxels, shape (N, B, output channels).

        Args:
            features: Of each voxel and sample, shape (N, B, input channels).
            maps: Of the membrane, or of a batch of membranes with B samples each.
        """
        samples = features.shape[1]
        activation = self.spec.activation
        rows = self.stem(features.reshape(-1, features.shape[2]), maps, samples)
        rows = activated(self.stem_norm(rows), activation)
        skips = [rows]
        for step, step_norm, block in zip(self.downs, self.down_norms, self.encoder, strict=True):
            rows = block(activated(step_norm(step(rows, maps, samples)), activation), maps, samples)
            skips.append(rows)
        skips.pop()
        for step, step_norm, block in zip(self.ups, self.up_norms, self.decoder, strict=True):
            rows = activated(step_norm(step(rows, maps, samples)), activation)
            rows = block(torch.cat([rows, skips.pop()], dim=1), maps, samples)
        return self.last(rows).view(-1, samples, self.spec.output_channels)

    def encoder_modules(self) -> tuple[nn.Module, ...]:
        """Everything up to the coarsest level."""
        return (self.stem, self.stem_norm, self.downs, self.down_norms, self.encoder)

    def decoder_parameters(self) -> Iterator[nn.Parameter]:
        """What fine-tuning for another stiffness trains."""
        for module in (self.ups, self.up_norms, self.decoder, self.last):
            yield from module.parameters()

    def freeze_encoder(self) -> None:
        """Keep the encoder as it is from now on, the statistics of its normalisation included."""
        self.encoder_is_frozen = True
        for module in self.encoder_modules():
            module.requires_grad_(False)
        self.train(self.training)

    def train(self, mode: bool = True) -> MinkUNet:
        """Switch to training or back; a frozen encoder goes on as in use."""
        super().train(mode)
        if self.encoder_is_frozen:
            for module in self.encoder_modules():
                module.train(False)
        return self


def new_network(spec: NetworkSpec, *, seed: int = 0) -> MinkUNet:
    """An untrained network: the same for the same seed, and no other random draw changes."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(seed)
        return MinkUNet(spec)


def parameter_count(network: nn.Module) -> int:
    """Trainable and frozen parameters; statistics are none."""
    return sum(parameter.numel() for parameter in network.parameters())


def network_of(weights: NetworkWeights) -> MinkUNet:
    """The network that the weights belong to, in the state they keep.

    Raises:
        StoreError: If the arrays are not those of the described network.
    """
    network = MinkUNet(weights.spec)
    state = {name: torch.from_numpy(array.copy()) for name, array in weights.arrays.items()}
    try:
        network.load_state_dict(state)
    except RuntimeError as error:
        raise StoreError(
            f"the weights do not fit the network {shown(weights.spec.name)} that they describe",
            hint="train the network again with this version",
            at="weights",
        ) from error
    return network


def arrays_of(network: nn.Module) -> dict[str, np.ndarray]:
    """The state of a network as NumPy arrays by name, copied: what `NetworkWeights` keeps."""
    state = network.state_dict()
    return {name: value.detach().cpu().numpy().copy() for name, value in state.items()}
