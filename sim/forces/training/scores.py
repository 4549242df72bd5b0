"""Errors of a network on samples, in float32, beside the predictor that always says zero."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import torch
from torch import Tensor

from sim.forces.network.minkunet import MinkUNet
from sim.forces.training.frames import Frame


def network_output(
    network: MinkUNet, frame: Frame, inputs: Tensor, *, half: torch.dtype | None = None
) -> Tensor:
    """What the network says at the points, float32, shape (V, B, C) from (V, B, I).

    Args:
        network: In training or in use.
        frame: The orientation that the inputs are in.
        inputs: What enters, over its scale.
        half: Type of the arithmetic inside the network; None: float32.
    """
    features = frame.voxels.mean(inputs)
    kind = features.device.type
    with torch.autocast(kind, dtype=half or torch.bfloat16, enabled=half is not None):
        values = network(features, frame.maps)
    return frame.voxels.to_points(values.float())


def sample_errors(
    network: MinkUNet,
    frame: Frame,
    inputs: Tensor,
    targets: Tensor,
    *,
    input_scale: Tensor,
    output_scale: float,
    batch: int,
    tick: Callable[[], None] = lambda: None,
) -> np.ndarray:
    """Mean absolute error of each sample, in the target's unit, shape (S,), float64.

    Args:
        network: In use.
        frame: The orientation that the fields are in.
        inputs: What enters, shape (S, V, I).
        targets: What is right, shape (S, V, C).
        input_scale: Of each channel that enters, shape (I,).
        output_scale: Of the network.
        batch: Samples at a time.
        tick: Called between batches; may raise.
    """
    errors = []
    for first in range(0, len(inputs), batch):
        tick()
        given = inputs[first : first + batch].transpose(0, 1) / input_scale
        wanted = targets[first : first + batch].transpose(0, 1)
        with torch.no_grad():
            found = network_output(network, frame, given.contiguous()) * output_scale
            errors.append((found - wanted).abs().mean(dim=(0, 2), dtype=torch.float64).cpu())
    return torch.cat(errors).numpy() if errors else np.zeros(0)
