"""Differences from rest as networks are shown them, and how they are varied for training.

They are divided by `GREY`. What is shown in training is made brighter or darker, each colour by
itself, and noisy, as other lights and other cameras would have it. Where directions do not count,
it is also turned, moved, enlarged and mirrored, and its colours change places, as behind lights
whose colours stand in another order.
"""

from __future__ import annotations

import math

import numpy as np
import torch
from torch import Tensor, nn

GREY = 48.0
"""Grey levels that count as one."""
GAIN = 0.25
"""By which each colour's difference is made stronger or weaker, at most [1]."""
NOISE = 2.0
"""Standard deviation of the noise that is added [grey level]."""
TURN_RAD, ZOOM, SHIFT = math.pi, 0.2, 0.15
"""By which images are turned, enlarged and moved at most; the last as a share of half a side."""
PLACE = 8
"""Numbers that say where and how strong a change is."""


def plain(inputs: np.ndarray, device: torch.device) -> Tensor:
    """Differences (B, T, h, w, 3) [grey level] as a network sees them, shape (B, T, 3, h, w)."""
    return torch.as_tensor(inputs, device=device).permute(0, 1, 4, 2, 3).float() / GREY


def varied(shown: Tensor, generator: torch.Generator, *, moved: bool) -> Tensor:
    """The same by another light and another camera, and where asked for another way round."""
    batch, device = len(shown), shown.device
    gain = torch.rand((batch, 1, 3, 1, 1), generator=generator, device=device)
    noise = torch.randn(shown.shape, generator=generator, device=device)
    other = shown * (1.0 + GAIN * (2.0 * gain - 1.0)) + NOISE / GREY * noise
    return turned(_recoloured(other, generator), generator, ZOOM, SHIFT) if moved else other


def _recoloured(shown: Tensor, generator: torch.Generator) -> Tensor:
    """Colours of each example in another order, all of its images alike."""
    drawn = torch.rand((len(shown), shown.shape[2]), generator=generator, device=shown.device)
    order = drawn.argsort(dim=1)[:, None, :, None, None].expand_as(shown)
    return shown.gather(2, order)


def turned(
    shown: Tensor, generator: torch.Generator, most_zoom: float, most_shift: float
) -> Tensor:
    """Images of examples (B, T, C, h, w) turned, moved, enlarged and mirrored, an example's alike.

    Args:
        shown: What is seen.
        generator: Of what is drawn.
        most_zoom: By which they are enlarged or made smaller at most [1].
        most_shift: By which they are moved at most, over half a side [1].
    """
    batch, frames, _, height, width = shown.shape

    def drawn(most: float) -> Tensor:
        return most * (2.0 * torch.rand(batch, generator=generator, device=shown.device) - 1.0)

    turn, zoom = drawn(TURN_RAD), 1.0 + drawn(most_zoom)
    mirror = torch.sign(drawn(1.0))
    ratio = height / width
    cosine, sine = zoom * torch.cos(turn), zoom * torch.sin(turn)
    rows = [
        torch.stack([mirror * cosine, -ratio * sine, drawn(most_shift)], dim=1),
        torch.stack([mirror * sine / ratio, cosine, drawn(most_shift)], dim=1),
    ]
    affine = torch.stack(rows, dim=1).repeat_interleave(frames, dim=0)
    flat = shown.flatten(0, 1)
    grid = nn.functional.affine_grid(affine, list(flat.shape), align_corners=False)
    return nn.functional.grid_sample(flat, grid, align_corners=False).reshape(shown.shape)
