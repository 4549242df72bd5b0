"""A committee of small networks over numbers of examples: what is told is the mean of their votes.

Each has two hidden layers and begins from other weights; alone it would be sure of what is chance
in a few hundred slides. Source: Hansen and Salamon, Neural network ensembles, 1990.
"""

from __future__ import annotations

import itertools

import torch
from torch import Tensor, nn

from workbench.core.base.monitor import Monitor
from workbench.tasks.networks.learn import SMOOTHING, Learned, Part, told_by

MEMBERS, HIDDEN, DROPOUT = 8, 48, 0.2
MOST = 4.0
"""Standard deviations from the middle beyond which a number counts no more."""
STEPS, BATCH, RATE, DECAY = 600, 128, 3e-3, 0.1
NOISE = 0.2
"""Added to numbers in training, over their standard deviation."""
TOLD_EVERY = 100
"""Steps after which the validation part is told."""
SETTINGS = {
    "steps": STEPS,
    "batch": BATCH,
    "rate": RATE,
    "decay": DECAY,
    "noise": NOISE,
    "members": MEMBERS,
    "hidden": HIDDEN,
    "dropout": DROPOUT,
    "most": MOST,
    "smoothing": SMOOTHING,
}
"""How it learns, as results tell it."""


class Committee(nn.Module):
    """Numbers (B, 1, F) to K logarithms of shares."""

    middle: Tensor
    spread: Tensor

    def __init__(self, outputs: int, part: Part) -> None:
        """Begin at random.

        Args:
            outputs: K.
            part: What it learns from: middle and spread of all it sees become 0 and 1.
        """
        super().__init__()
        self.outputs = outputs
        seen = torch.as_tensor(part.inputs[:, 0, 0]).float()
        spread = seen.std(dim=0, correction=0)
        self.register_buffer("middle", seen.mean(dim=0))
        self.register_buffer("spread", torch.where(spread > 0.0, spread, 1.0))
        sizes = (seen.shape[1], HIDDEN, HIDDEN, outputs)
        self.layers = nn.ModuleList(
            _Layer(before, after) for before, after in itertools.pairwise(sizes)
        )
        self.dropout = nn.Dropout(DROPOUT)

    def even(self, seen: Tensor) -> Tensor:
        """Numbers (..., F) with middle 0 and spread 1."""
        return ((seen - self.middle) / self.spread).clamp(-MOST, MOST)

    def votes(self, even: Tensor) -> Tensor:
        """What members say of even numbers, each of its own, (M, B, F) to (M, B, K)."""
        for layer in self.layers[:-1]:
            even = self.dropout(torch.relu(layer(even)))
        return self.layers[-1](even)

    def forward(self, seen: Tensor, at: Tensor) -> Tensor:
        """Means of the logarithms of members' shares, shape (B, K); where it is does not count."""
        even = self.even(seen[:, 0]).expand(MEMBERS, -1, -1)
        return self.votes(even).log_softmax(dim=2).mean(dim=0)


class _Layer(nn.Module):
    """A linear map of each member."""

    def __init__(self, before: int, after: int) -> None:
        super().__init__()
        self.weight = nn.Parameter(torch.randn(MEMBERS, before, after) * (2.0 / before) ** 0.5)
        self.bias = nn.Parameter(torch.zeros(MEMBERS, 1, after))

    def forward(self, seen: Tensor) -> Tensor:
        """Of (M, B, before) to (M, B, after)."""
        return torch.baddbmm(self.bias, seen, self.weight)


def learn_committee(
    committee: Committee, parts: tuple[Part, Part], seed: int, monitor: Monitor
) -> Learned:
    """Train all members, each on examples that are drawn for it; classes count the same.

    It learns for a fixed number of steps and ends with its last weights: the validation part only
    tells how far it came.

    Args:
        committee: On the device where it learns.
        parts: What it learns from, and what tells how far it came.
        seed: Of examples and noise; what drops out goes by the generator of torch.
        monitor: Progress and cancellation.

    Raises:
        Cancelled: If the monitor says so.
    """
    train, validation = parts
    device = committee.middle.device
    even = committee.even(torch.as_tensor(train.inputs[:, 0, 0], device=device).float())
    truth = torch.as_tensor(train.truth, device=device)
    often = torch.bincount(truth, minlength=committee.outputs)
    balance = (1.0 / often.clamp(min=1).float())[truth]
    generator = torch.Generator(device=device).manual_seed(seed)
    optimiser = torch.optim.AdamW(committee.parameters(), lr=RATE, weight_decay=DECAY)
    rates = torch.optim.lr_scheduler.OneCycleLR(optimiser, RATE, total_steps=STEPS)
    curve = []
    for step in range(STEPS):
        committee.train()
        shape = (MEMBERS, BATCH)
        rows = torch.randint(len(truth), shape, generator=generator, device=device)
        noise = torch.randn((*shape, even.shape[1]), generator=generator, device=device)
        votes = committee.votes(even[rows] + NOISE * noise)
        # Weights of classes would weigh what smoothing adds as well, and tell rare ones too often.
        each = nn.functional.cross_entropy(
            votes.flatten(0, 1),
            truth[rows].flatten(),
            label_smoothing=SMOOTHING,
            reduction="none",
        )
        weight = balance[rows].flatten()
        loss = (each * weight).sum() / weight.sum()
        optimiser.zero_grad()
        loss.backward()
        optimiser.step()
        rates.step()
        monitor(step / STEPS, f"step {step + 1} of {STEPS}")
        if (step + 1) % TOLD_EVERY == 0:
            told = told_by(committee, validation.inputs, validation.at)
            left = float((told.argmax(axis=1) != validation.truth).mean())
            curve.append({"train": float(loss.detach()), "validation": left})
    return Learned(epoch=len(curve), curve=curve)
