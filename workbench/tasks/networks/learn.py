"""One training: epochs of a network over its part, the best epoch by the validation part."""

from __future__ import annotations

import copy
from dataclasses import dataclass

import numpy as np
import torch
from torch import Tensor, nn

from workbench.core.base.monitor import Monitor
from workbench.tasks.networks.shown import plain, varied

SMOOTHING = 0.1
"""Share of a class that is given to all: with few images networks grow too sure."""
OF_LOSS = 1e-3
"""By which the loss chooses among epochs that tell equally many right."""
AT_ONCE = 64
"""Examples of a forward pass without training."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Settings:
    """How long and how fast it learns."""

    epochs: int
    rate: float
    """Largest step of Adam [1]; it falls to nothing along half a cosine."""
    batch: int
    decay: float
    """Weight decay of Adam [1]."""
    moved: bool
    """Whether images may be turned, moved, enlarged and mirrored."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Part:
    """Inputs with what is to be told."""

    inputs: np.ndarray
    """What is seen [grey level], shape (N, T, h, w, 3), int16; or features and those of varied
    copies, shape (N, 1 + copies, T, F), of 16 or 32 bit."""
    at: np.ndarray
    """Where and how strong it is, shape (N, 8), float32."""
    truth: np.ndarray
    """Number of the class, (N,), int64; or scaled values, (N, K), float."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Learned:
    """What a training gives; the network itself holds the best epoch's weights."""

    epoch: int
    """The best one, from 1; of a regression the number of its penalty."""
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
    optimiser = torch.optim.AdamW(
        network.parameters(), lr=settings.rate, weight_decay=settings.decay
    )
    steps = settings.epochs * -(-len(train.truth) // settings.batch)
    falling = torch.optim.lr_scheduler.CosineAnnealingLR(optimiser, max(steps, 1))
    best, kept, epoch_kept = np.inf, copy.deepcopy(network.state_dict()), 0
    curve, taken = [], 0
    for epoch in range(settings.epochs):
        network.train()
        total = 0.0
        order = rng.permutation(len(train.truth))
        # One example alone has no spread, which batch norm divides by.
        batches = [rows for rows in _batches(order, settings.batch) if len(rows) > 1]
        for rows in batches:
            shown = _training(train.inputs[rows], device, generator, moved=settings.moved)
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
    """What a network says of the inputs of a part, shape (N, K), float32."""
    network.eval()
    device = next(network.parameters()).device
    found = [np.zeros((0, 1), np.float32)]
    with torch.no_grad():
        for rows in _batches(np.arange(len(inputs)), AT_ONCE):
            told = network(_testing(inputs[rows], device), torch.as_tensor(at[rows], device=device))
            found.append(told.float().cpu().numpy())
    return np.concatenate(found[1:] or found)


def _batches(order: np.ndarray, size: int) -> list[np.ndarray]:
    return [order[first : first + size] for first in range(0, len(order), size)]


def _testing(inputs: np.ndarray, device: torch.device) -> Tensor:
    if inputs.ndim == 4:
        return torch.as_tensor(inputs[:, 0], device=device).float()
    return plain(inputs, device)


def _training(
    inputs: np.ndarray, device: torch.device, generator: torch.Generator, *, moved: bool
) -> Tensor:
    """Images varied; of features those of one of the copies."""
    if inputs.ndim == 4:
        count, copies = inputs.shape[:2]
        drawn = torch.randint(copies, (count,), generator=generator, device=device).cpu().numpy()
        return torch.as_tensor(inputs[np.arange(count), drawn], device=device).float()
    return varied(plain(inputs, device), generator, moved=moved)


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
