"""What a network is taught: on which views, from which weights, how long."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.reading.network.spec import ReaderSpec, Scales
from workbench.learning.readers.view_set import ViewSet

if TYPE_CHECKING:
    from sim.reading.network.unet import UNet

RATE, RATE_OF_LEARNED = 2e-3, 5e-4
"""Largest rate of learning [1], of a network that knows nothing and of one that begins from a
reader."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Lesson:
    """What is learned, on what, how long."""

    learned: ViewSet
    validation: ViewSet
    spec: ReaderSpec
    scales: Scales
    seconds: float
    epochs: int
    """At most; 0: as many as there is time for."""
    seed: int
    device: str
    key: str
    """Of data and settings: a checkpoint of another one is refused."""
    start: Mapping[str, np.ndarray] | None = None
    """Folded weights by name to begin from; None: from nothing."""

    @property
    def rate(self) -> float:
        """The largest rate of learning."""
        return RATE if self.start is None else RATE_OF_LEARNED

    def network(self) -> UNet:
        """What learns. Normalisation serves one that knows nothing; folded weights have theirs."""
        import torch

        from sim.reading.network.unet import UNet

        network = UNet(self.spec, normed=self.start is None)
        if self.start is not None:
            state = {name: torch.from_numpy(array.copy()) for name, array in self.start.items()}
            network.load_state_dict(state)
        return network

    def usable(self, network: UNet) -> dict[str, np.ndarray]:
        """The folded weights of what has learned, by name, float32."""
        from sim.reading.network.unet import folded_state

        state = folded_state(network) if self.start is None else network.state_dict()
        return {name: value.detach().float().cpu().numpy() for name, value in state.items()}
