"""A reader as one module from grey levels to units, for programs that know nothing of it."""

from __future__ import annotations

import numpy as np
import torch
from torch import nn

from sim.reading.network.given import given
from sim.reading.network.loss import LOG_RANGE
from sim.reading.network.reader_file import ReaderFile
from sim.reading.network.spec import DEPTH
from sim.reading.network.unet import network_of


class Standalone(nn.Module):
    """Photographs at rest and touched, (B, 3, H, W), to depth, sees, force and its deviation."""

    sees: torch.Tensor

    def __init__(self, reader: ReaderFile) -> None:
        super().__init__()
        state = {
            name: torch.from_numpy(np.ascontiguousarray(a)) for name, a in reader.arrays.items()
        }
        self.network = network_of(reader.spec, state)
        self.rows = reader.spec.rows
        self.force_N = reader.scales.force_N
        self.sigma_N = reader.scales.force_N * reader.scales.force_sigma
        self.register_buffer("sees", torch.from_numpy(reader.rest.sees))

    def forward(self, idle: torch.Tensor, photos: torch.Tensor) -> tuple[torch.Tensor, ...]:
        """Depth [mm] (B, H, W), pixels that see skin (B, H, W), force [N] (B, 3) and (B,)."""
        maps, force = self.network(given(idle, photos))
        deviation = torch.exp(0.5 * force[:, 3].clamp(LOG_RANGE[0], LOG_RANGE[1]))
        return (
            maps[:, DEPTH, : self.rows],
            self.sees[None].expand(len(photos), -1, -1),
            self.force_N * force[:, :3],
            self.sigma_N * deviation,
        )


def standalone(reader: ReaderFile) -> Standalone:
    """The module of a reader, in use."""
    return Standalone(reader).eval()
