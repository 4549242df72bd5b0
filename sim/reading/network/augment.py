"""What another sensor, another camera setting and another photograph make of the same touch.

Grey levels are multiplied, which stands for exposure and white balance: of a gamma of 2.2 a gain
in light is a gain in grey. Amounts are our choice, for a camera whose automatics are switched off.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch.nn import functional


@dataclass(frozen=True, kw_only=True, slots=True)
class Disturbance:
    """Largest amounts; each image draws its own, evenly."""

    noise_grey: float = 2.0
    """Standard deviation of a pixel; the photograph at rest draws its own."""
    exposure: float = 0.15
    """Share of both photographs' grey levels."""
    balance: float = 0.06
    """Likewise, of each colour by itself."""
    flicker: float = 0.01
    """Share by which the touched photograph differs."""
    offset_grey: float = 1.0
    """By which each colour of it differs."""
    blur_px: float = 0.9
    """Standard deviation of a blur of both."""


NONE = Disturbance(noise_grey=0, exposure=0, balance=0, flicker=0, offset_grey=0, blur_px=0)
"""Photographs as they were rendered."""
REACH_PX = 3
"""Half width of the blur's kernel."""


def disturbed(
    idle: torch.Tensor,
    photos: torch.Tensor,
    amounts: Disturbance,
    generator: torch.Generator,
) -> tuple[torch.Tensor, torch.Tensor]:
    """Both photographs as another camera would have taken them, grey levels (B, 3, H, W) each."""
    count, device = len(photos), photos.device

    def drawn(*shape: int) -> torch.Tensor:
        return torch.rand(count, *shape, generator=generator, device=device)

    def even(amount: float, *shape: int) -> torch.Tensor:
        return amount * (2.0 * drawn(*shape) - 1.0)

    gain = (1.0 + even(amounts.exposure, 1, 1, 1)) * (1.0 + even(amounts.balance, 3, 1, 1))
    flicker = 1.0 + even(amounts.flicker, 1, 1, 1)
    pair = torch.cat([idle * gain, photos * (gain * flicker)])
    if amounts.blur_px > 0.0:
        width = amounts.blur_px * drawn(1)[:, 0]
        pair = _blurred(pair, width.repeat(2))
    offset = even(amounts.offset_grey, 3, 1, 1)
    pair = torch.cat([pair[:count], pair[count:] + offset])
    if amounts.noise_grey > 0.0:
        sigma = amounts.noise_grey * torch.cat([drawn(1, 1, 1), drawn(1, 1, 1)])
        pair = pair + sigma * torch.randn(pair.shape, generator=generator, device=device)
    # Cameras say whole levels from black to white.
    pair = pair.clamp(0.0, 255.0).round()
    return pair[:count], pair[count:]


def _blurred(images: torch.Tensor, sigma_px: torch.Tensor) -> torch.Tensor:
    """Each image (B, 3, H, W) blurred by its own Gaussian, sigma (B,)."""
    way = torch.arange(-REACH_PX, REACH_PX + 1, device=images.device, dtype=images.dtype)
    kernel = torch.exp(-0.5 * (way / sigma_px.clamp(min=0.05)[:, None]) ** 2)
    kernel = kernel / kernel.sum(dim=1, keepdim=True)
    count, colours, rows, columns = images.shape
    flat = images.reshape(1, count * colours, rows, columns)
    weights = kernel.repeat_interleave(colours, dim=0)[:, None]
    for shape, pad in (((-1, 1, 1, 7), (3, 3, 0, 0)), ((-1, 1, 7, 1), (0, 0, 3, 3))):
        flat = functional.pad(flat, pad, mode="replicate")
        flat = functional.conv2d(flat, weights.reshape(shape), groups=count * colours)
    return flat.reshape(images.shape)
