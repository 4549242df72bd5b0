"""Errors of a network on samples, in float32, beside the predictor that always says zero."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.minkunet import MinkUNet
from sim.forces.training.feeds import Batch, Feed


def network_output(network: MinkUNet, batch: Batch, *, half: torch.dtype | None = None) -> Tensor:
    """What the network says at the points, over its scale, float32, shape (P, B, C).

    Args:
        network: In training or in use.
        batch: What enters.
        half: Type of the arithmetic inside the network; None: float32.
    """
    features = batch.voxels.mean(batch.inputs)
    kind = features.device.type
    with torch.autocast(kind, dtype=half or torch.bfloat16, enabled=half is not None):
        values = network(features, batch.maps)
    return batch.voxels.to_points(values.float())


def sample_errors(
    network: MinkUNet,
    feed: Feed,
    *,
    output_scale: float,
    batch: int,
    tick: Callable[[], None] = lambda: None,
) -> np.ndarray:
    """Mean absolute error of each sample, in the target's unit, shape (S,), float64.

    Args:
        network: In use.
        feed: The samples.
        output_scale: Of the network.
        batch: Samples at a time.
        tick: Called between batches; may raise.
    """
    errors = []
    for first in range(0, len(feed), batch):
        tick()
        own = feed.batch(range(first, min(first + batch, len(feed))), None)
        with torch.no_grad():
            away = (network_output(network, own) - own.targets).abs().double()
            errors.append(own.errors(away).cpu() * output_scale)
    return torch.cat(errors).numpy() if errors else np.zeros(0)
