"""A running average of a network's state: steadier than the last weights, and often better.

a <- d a + (1 - d) w after every step, with d = min(decay, (1 + n) / (10 + n)) at step n, so that
the beginning is forgotten fast. Means and variances of normalisations are averaged alike; counters
are copied.

Source: B. Polyak, A. Juditsky, "Acceleration of Stochastic Approximation by Averaging", SIAM J.
Control Optim. 30 (1992); the ramp is that of TensorFlow's ExponentialMovingAverage.
"""

from __future__ import annotations

import copy

import torch
from torch.optim.swa_utils import get_ema_multi_avg_fn

from sim.forces.network.minkunet import MinkUNet


class Average:
    """A copy of a network that follows it."""

    def __init__(self, network: MinkUNet, decay: float) -> None:
        self.network = copy.deepcopy(network).requires_grad_(False).eval()
        self._decay = decay

    def follow(self, network: MinkUNet, step: int) -> None:
        """Move toward the network after a step, counted from 0."""
        keep = min(self._decay, (1 + step) / (10 + step))
        theirs = network.state_dict()
        floats, news = [], []
        with torch.no_grad():
            for name, own in self.network.state_dict().items():
                if own.is_floating_point():
                    floats.append(own)
                    news.append(theirs[name].detach())
                else:
                    own.copy_(theirs[name])
        get_ema_multi_avg_fn(keep)(floats, news, step)
