"""One training: epochs of a network over its part, the best epoch by the validation part.

Differences from rest are divided by `GREY`. What is shown in training is made brighter or darker,
each colour by itself, and noisy, as other lights and other cameras would have it. Where the place
does not count, it is also turned, moved, enlarged and mirrored.
"""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from workbench.core.base.monitor import Monitor

GREY = 48.0
"""Grey levels that count as one."""
GAIN = 0.25
"""By which each colour's difference is made stronger or weaker, at most [1]."""
NOISE = 2.0
"""Standard deviation of the noise that is added [grey level]."""
TURN_RAD, ZOOM, SHIFT = 0.5, 0.2, 0.15
"""By which images are turned, enlarged and moved at most; the last as a share of half a side."""
SMOOTHING = 0.1
"""Share of a class that is given to all: with few images networks grow too sure."""
WEIGHT_DECAY = 1e-3
OF_LOSS = 1e-3
"""By which the loss chooses among epochs that tell equally many right."""
AT_ONCE = 64
"""Examples of a forward pass without training."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Settings:
    """How long and how fast it learns."""

    epochs: int
    moved: bool
    """Whether what is shown may be turned, moved, enlarged and mirrored."""
    rate: float
    """Largest step of Adam [1]; it falls to nothing along half a cosine."""
    batch: int


@dataclass(frozen=True, kw_only=True, slots=True)
class Part:
    """Inputs with what is to be told."""

    inputs: np.ndarray
    """Differences [grey level], shape (N, T, h, w, 3), int16."""
    at: np.ndarray
    """Middle and side of what is shown, shape (N, 3), float32."""
    truth: np.ndarray
    """Number of the class, (N,), int64; or scaled values, (N, K), float."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Learned:
    """What a training gives; the network itself holds the best epoch's weights."""

    epoch: int
    """The best one, from 1."""
    curve: list[dict[str, float]]
    """After each epoch the loss of training, and what is left in the validation part."""


def learn(
    network: nn.Module, parts: tuple[Part, Part], settings: Settings, seed: int, monitor: Monitor
) -> Learned:
    """Train a network; it ends with the weights of its best epoch.

    Args:
        network: On the device where it learns.
        parts: What it learns from, and what chooses the epoch.
        settings: Epochs, step and batch.
        seed: Of the order and of what is added.
        monitor: Progress and cancellation, asked after every batch.

    Raises:
        Cancelled: If the monitor says so.
    """
    train, validation = parts
    device = next(network.parameters()).device
    rng = np.random.default_rng((seed, 5))
    generator = torch.Generator(device=device).manual_seed(seed)
    optimiser = torch.optim.AdamW(network.parameters(), lr=settings.rate, weight_decay=WEIGHT_DECAY)
    steps = settings.epochs * -(-len(train.truth) // settings.batch)
    falling = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, max(steps, 1))
    best, kept, curve, taken = np.inf, copy.deepcopy(network.state_dict()), [], 0
    epoch_kept = 0
    for epoch in range(settings.epochs):
        network.train()
        total = 0.0
        order = rng.permutation(len(train.truth))
        # One example alone has no spread, which batch norm divides by.
        batches = [part for part in _batches(order, settings.batch) if len(part) > 1]
        for rows in batches:
            shown = _varied(_tensor(train.inputs[rows], device), generator)
            if settings.moved:
                shown = _moved(shown, generator)
            at = torch.as_tensor(train.at[rows], device=device)
            loss = _loss(network(shown, at), torch.as_tensor(train.truth[rows], device=device))
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            falling.step()
            total += float(loss.detach()) * len(rows)
            taken += 1
            monitor(min(1.0, taken / steps), f"epoch {epoch + 1} of {settings.epochs}")
        told = told_by(network, validation.inputs, validation.at)
        left = _left(told, validation.truth)
        curve.append({"train": total / max(1, sum(map(len, batches))), "validation": left})
        if left < best:
            best, kept, epoch_kept = left, copy.deepcopy(network.state_dict()), epoch + 1
    network.load_state_dict(kept)
    return Learned(epoch=epoch_kept, curve=curve)


def told_by(network: nn.Module, inputs: np.ndarray, at: np.ndarray) -> np.ndarray:
    """What a network says of inputs (N, T, h, w, 3) about (N, 3), shape (N, K), float32."""
    network.eval()
    device = next(network.parameters()).device
    with torch.no_grad():
        found = [
            network(_tensor(inputs[rows], device), torch.as_tensor(at[rows], device=device))
            .float()
            .cpu()
            .numpy()
            for rows in _batches(np.arange(len(inputs)), AT_ONCE)
        ]
    return np.concatenate(found) if found else np.zeros((0, 1), np.float32)


def _batches(order: np.ndarray, size: int) -> list[np.ndarray]:
    return [order[first : first + size] for first in range(0, len(order), size)]


def _tensor(inputs: np.ndarray, device: torch.device) -> Tensor:
    """Differences as a network sees them, shape (B, T, 3, h, w)."""
    return torch.as_tensor(inputs, device=device).permute(0, 1, 4, 2, 3).float() / GREY


def _varied(shown: Tensor, generator: torch.Generator) -> Tensor:
    batch, device = len(shown), shown.device
    gain = torch.rand((batch, 1, 3, 1, 1), generator=generator, device=device)
    noise = torch.randn(shown.shape, generator=generator, device=device)
    return shown * (1.0 + GAIN * (2.0 * gain - 1.0)) + NOISE / GREY * noise


def _moved(shown: Tensor, generator: torch.Generator) -> Tensor:
    """Images of an example turned, moved, enlarged and mirrored alike."""
    batch, frames, _, height, width = shown.shape

    def drawn(most: float) -> Tensor:
        return most * (2.0 * torch.rand(batch, generator=generator, device=shown.device) - 1.0)

    turn, zoom = drawn(TURN_RAD), 1.0 + drawn(ZOOM)
    mirror = torch.sign(drawn(1.0))
    ratio = height / width
    cosine, sine = zoom * torch.cos(turn), zoom * torch.sin(turn)
    rows = [
        torch.stack([mirror * cosine, -ratio * sine, drawn(SHIFT)], dim=1),
        torch.stack([mirror * sine / ratio, cosine, drawn(SHIFT)], dim=1),
    ]
    affine = torch.stack(rows, dim=1).repeat_interleave(frames, dim=0)
    flat = shown.flatten(0, 1)
    grid = nn.functional.affine_grid(affine, list(flat.shape), align_corners=False)
    return nn.functional.grid_sample(flat, grid, align_corners=False).reshape(shown.shape)


def _left(told: np.ndarray, truth: np.ndarray) -> float:
    """Share of classes told wrongly, and a little of the loss where that is the same; or error."""
    loss = float(_loss(torch.as_tensor(told), torch.as_tensor(truth)))
    if truth.dtype != np.int64:
        return loss
    return float((told.argmax(axis=1) != truth).mean()) + OF_LOSS * loss


def _loss(told: Tensor, truth: Tensor) -> Tensor:
    """Cross entropy of classes, mean absolute error of values."""
    if truth.dtype == torch.int64:
        return nn.functional.cross_entropy(told, truth, label_smoothing=SMOOTHING)
    return (told - truth.to(told.dtype)).abs().mean()
