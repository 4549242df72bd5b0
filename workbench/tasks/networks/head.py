"""A head over features of examples: a linear map, solved for with a penalty on its size.

It tells numbers by ridge regression. Source: Hoerl and Kennard, Ridge regression, 1970.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import torch
from torch import Tensor, nn

from workbench.tasks.networks.learn import Learned, Part

WEIGHT = 5.0
"""How much more each number of the place counts than each of the features, which are many."""
PENALTIES = (0.3, 3.0, 30.0, 300.0, 3e3, 3e4, 3e5)
"""Of ridge regression."""


class Head(nn.Module):
    """Features (B, 1, F) to K numbers."""

    middle: Tensor
    spread: Tensor
    known: Tensor

    def __init__(
        self,
        outputs: int,
        part: Part,
        *,
        told_places: bool,
        known: Mapping[int, float] | None = None,
    ) -> None:
        """Begin at random.

        Args:
            outputs: K.
            part: What it learns from: middle and spread of all it sees become 0 and 1.
            told_places: Whether the place of a contact counts. It leads classes astray where
                presses are few, and pressures on photographs, whose differences are other ones.
            known: Weights of features, by their numbers, that no learning is needed for: only what
                they leave is learned, so that a large penalty ends with them, not with the mean.
        """
        super().__init__()
        self.told_places = told_places
        seen = part.inputs.reshape(-1, part.inputs.shape[-1]).astype(np.float32)
        placed = self.places(torch.as_tensor(part.at)).numpy()
        middle = np.concatenate([seen.mean(axis=0), placed.mean(axis=0)])
        spread = np.concatenate([seen.std(axis=0), placed.std(axis=0) / WEIGHT])
        spread = np.where(spread > 0.0, spread, 1.0)
        self.register_buffer("middle", torch.as_tensor(middle, dtype=torch.float32))
        self.register_buffer("spread", torch.as_tensor(spread, dtype=torch.float32))
        features, places = seen.shape[1], placed.shape[1]
        weights = torch.zeros(features)
        for feature, weight in (known or {}).items():
            weights[feature] = weight
        self.register_buffer("known", weights)
        self.one = nn.Linear(features + places, outputs)

    def places(self, at: Tensor) -> Tensor:
        """Where and how strong it is, with squares and products, (B, 8) to (B, 44); or nothing."""
        if not self.told_places:
            return at[:, :0]
        rows, columns = np.triu_indices(at.shape[1])
        return torch.cat([at, at[:, rows] * at[:, columns]], dim=1)

    def even(self, seen: Tensor, at: Tensor) -> tuple[Tensor, Tensor]:
        """Features (B, 1, F) and where they are (B, P), all of middle 0 and spread 1."""
        count = seen.shape[-1]
        placed = (self.places(at) - self.middle[count:]) / self.spread[count:]
        return (seen - self.middle[:count]) / self.spread[:count], placed

    def forward(self, seen: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K), with where and how strong it is, (B, 8)."""
        even, placed = self.even(seen, at)
        return self.one(torch.cat([even[:, 0], placed], dim=1)) + self.before(seen)

    def before(self, seen: Tensor) -> Tensor:
        """What is known of features (B, 1, F) without learning, shape (B, 1)."""
        return seen[:, 0] @ self.known[:, None]


def fit_values(head: Head, parts: tuple[Part, Part], *, cautious: bool = False) -> Learned:
    """Solve a head for values of single images: ridge regression on all that it sees.

    It ends with the penalty, of `PENALTIES`, that leaves the least error in the validation part.

    Args:
        head: Made for the first of the parts.
        parts: What it learns from, copies too, and what chooses the penalty.
        cautious: Whether to end with the largest penalty whose error is within one standard error
            of the least: what the smaller ones gain there is chance, and photographs are further
            from renders than renders are from each other. Source of the rule: Breiman, Friedman,
            Olshen and Stone, Classification and regression trees, 1984, section 3.4.3.
    """
    train, validation = parts
    copies = train.inputs.shape[1]
    known = np.concatenate([_row(head, train, copy) for copy in range(copies)])
    truth = np.concatenate([_left(head, train, copy) for copy in range(copies)])
    held_out, wanted = _row(head, validation, 0), _left(head, validation, 0)
    middle = truth.mean(axis=0)
    found, errors, curve = list(ridge(known, truth - middle)), [], []
    for weights in found:
        errors.append(np.abs(held_out @ weights + middle - wanted).mean(axis=1))
        learned = float(np.abs(known @ weights + middle - truth).mean())
        curve.append({"train": learned, "validation": float(errors[-1].mean())})
    least = min(errors, key=np.mean)
    most = least.mean() + (least.std() / np.sqrt(len(least)) if cautious else 0.0)
    chosen = max(number for number, each in enumerate(errors) if each.mean() <= most)
    device = head.middle.device
    head.one.weight.data = torch.as_tensor(found[chosen].T, dtype=torch.float32, device=device)
    head.one.bias.data = torch.as_tensor(middle, dtype=torch.float32, device=device)
    return Learned(epoch=chosen + 1, curve=curve)


def ridge(known: np.ndarray, truth: np.ndarray) -> Iterator[np.ndarray]:
    """Weights (F, K) of ridge regression for each of `PENALTIES`.

    With X = `known` (N, F) and Y = `truth` (N, K) they are X^T (X X^T + p)^-1 Y or, the same,
    (X^T X + p)^-1 X^T Y: the smaller of the two matrices is decomposed, once for all penalties.
    """
    count, features = known.shape
    if count < features:
        values, vectors = np.linalg.eigh(known @ known.T)
        before, given = known.T @ vectors, vectors.T @ truth
    else:
        values, vectors = np.linalg.eigh(known.T @ known)
        before, given = vectors, vectors.T @ (known.T @ truth)
    for penalty in PENALTIES:
        yield before @ (given / (values[:, None] + penalty))


def _left(head: Head, part: Part, copy: int) -> np.ndarray:
    """Values of a part less what a head knows before it learns, shape (N, K)."""
    seen = torch.as_tensor(part.inputs[:, copy], device=head.middle.device).float()
    return part.truth.astype(np.float64) - head.before(seen).cpu().numpy().astype(np.float64)


def _row(head: Head, part: Part, copy: int) -> np.ndarray:
    """All that a head sees of a part, by one of the copies, shape (N, F + P)."""
    device = head.middle.device
    seen = torch.as_tensor(part.inputs[:, copy], device=device).float()
    with torch.no_grad():
        even, placed = head.even(seen, torch.as_tensor(part.at, device=device))
        return torch.cat([even[:, 0], placed], dim=1).cpu().numpy().astype(np.float64)
