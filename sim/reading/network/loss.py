"""What a network is punished for.

    depth, surface   |d - d*|, moved skin counts more; and the negative log likelihood of d* with
                     d held: |d - d*|^2 / (2 s^2) + log s
    turn             |t - t*|
    touch            cross entropy of d* > .05 mm
    pressure, force  |p - p*|, and the likelihood of the force: only of solved presses

The mean is thus learned by robust losses alone, and variances do not pull at it.
Source of the likelihood: Kendall and Gal, What uncertainties do we need, 2017.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch.nn import functional

from sim.reading.network.spec import (
    DEPTH,
    LOG_VARIANCE,
    PRESSURE,
    SURFACE,
    TOUCH,
    TURN,
    Scales,
)
from sim.reading.pixel_maps import TOUCHED_MM

MOVED_WEIGHT = 20.0
"""Of pixels whose skin moved, over others, which are many more."""
TURN_WEIGHT, TOUCH_WEIGHT, PRESSURE_WEIGHT = 0.5, 0.05, 0.2
VARIANCE_WEIGHT, FORCE_WEIGHT = 0.01, 0.1
LOG_RANGE = (-14.0, 4.0)
"""Of log variances: 1 um to 7 mm."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Wanted:
    """What is true of B images."""

    depth_mm: torch.Tensor
    """Shape (B, H, W); NaN where a pixel sees no skin."""
    surface_mm: torch.Tensor
    """Of the skin that it saw at rest, shape (B, H, W)."""
    turn: torch.Tensor
    """Shape (B, 3, H, W)."""
    pressure_MPa: torch.Tensor
    """Shape (B, H, W)."""
    force_N: torch.Tensor
    """Shape (B, 3)."""
    solved: torch.Tensor
    """Whether pressure and force are known, shape (B,), float."""


def loss(
    maps: torch.Tensor, force: torch.Tensor, wanted: Wanted, scales: Scales
) -> dict[str, torch.Tensor]:
    """The parts, each weighted; their sum is what training makes small.

    Args:
        maps: As the network gives them, shape (B, OUTPUTS, H, W).
        force: Likewise, shape (B, 4).
        wanted: The truth.
        scales: Units of pressure and force.
    """
    seen = torch.isfinite(wanted.depth_mm)
    truth = torch.nan_to_num(wanted.depth_mm)
    touched = (truth > TOUCHED_MM).float()
    weight = seen * (1.0 + (MOVED_WEIGHT - 1.0) * touched)
    total = weight.sum()
    off = maps[:, DEPTH] - truth
    surface = (maps[:, SURFACE] - wanted.surface_mm).abs()
    surface_weight = 1.0 + (MOVED_WEIGHT - 1.0) * (wanted.surface_mm > TOUCHED_MM)
    turn = (maps[:, TURN] - wanted.turn).abs().sum(dim=1)
    touch = functional.binary_cross_entropy_with_logits(maps[:, TOUCH], touched, reduction="none")
    log_variance = maps[:, LOG_VARIANCE].clamp(*LOG_RANGE)
    told = 0.5 * (off.detach() ** 2 * torch.exp(-log_variance) + log_variance)
    solved = wanted.solved[:, None, None]
    pressure = (maps[:, PRESSURE] - wanted.pressure_MPa / scales.pressure_MPa).abs() * solved
    shear = (force[:, :3] - wanted.force_N / scales.force_N) * wanted.solved[:, None]
    variance = force[:, 3].clamp(*LOG_RANGE)
    likely = 0.5 * ((shear.detach() ** 2).mean(dim=1) * torch.exp(-variance) + variance)
    known = wanted.solved.sum().clamp(min=1.0)
    return {
        "depth": (weight * off.abs()).sum() / total,
        "surface": (surface_weight * seen * surface).sum() / total,
        "turn": TURN_WEIGHT * (weight * turn).sum() / total,
        "touch": TOUCH_WEIGHT * (seen * touch).sum() / seen.sum(),
        "pressure": PRESSURE_WEIGHT * (weight * pressure).sum() / total,
        "variance": VARIANCE_WEIGHT * (weight * told).sum() / total,
        "force": FORCE_WEIGHT * functional.smooth_l1_loss(shear, 0.0 * shear, beta=0.1) * 4.0
        + VARIANCE_WEIGHT * (likely * wanted.solved).sum() / known,
    }
