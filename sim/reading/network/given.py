"""What enters a network, from two photographs."""

from __future__ import annotations

import torch
from torch.nn import functional

from sim.reading.network.spec import STEP

DIFFERENCE_GREY = 32.0
"""Differences are divided by it."""


def given(idle: torch.Tensor, photos: torch.Tensor) -> torch.Tensor:
    """The channels that enter, (B, INPUTS, H, W), float32, padded below and right to whole steps.

    Args:
        idle: Grey levels at rest, shape (B, 3, H, W), or one for all.
        photos: Touched, shape (B, 3, H, W).
    """
    count, rows, columns = photos.shape[0], int(photos.shape[2]), int(photos.shape[3])
    idle = idle.expand(count, -1, -1, -1)
    across = torch.linspace(-0.5, 0.5, columns, device=photos.device)
    down = torch.linspace(-0.5, 0.5, rows, device=photos.device)
    place = torch.stack(torch.meshgrid(down, across, indexing="ij"))[None]
    difference = (photos - idle) / DIFFERENCE_GREY
    found = torch.cat([difference, idle / 255.0 - 0.5, place.expand(count, -1, -1, -1)], dim=1)
    more = (0, -columns % STEP, 0, -rows % STEP)
    return functional.pad(found, more, mode="replicate") if any(more) else found
