"""The paper's networks: ResNet50 for single images, VGG19 and an LSTM for windows.

Their ImageNet weights are those of torchvision, which are in no package: where the cache of PyTorch
(`torch.hub`) has the files they are used, else they are fetched if the machine may, else the
networks begin at random weights, and results say so.
Source of the layers behind VGG: the released script, 4096 -> 512 -> LSTM of two layers, 512 -> 256
-> classes.
"""

from __future__ import annotations

import pickle
from collections.abc import Mapping
from typing import Any

import torch
from torch import Tensor, nn

from workbench.tasks.networks.imagenet import DENSE, ResNet50, Vgg19

IMAGENET, RANDOM = "ImageNet weights of torchvision", "random weights"
PLACE = "https://download.pytorch.org/models"
FILES = {ResNet50: "resnet50-11ad3fa6.pth", Vgg19: "vgg19_bn-c79401a0.pth"}
"""Of torchvision: `IMAGENET1K_V2` and `IMAGENET1K_V1`."""
REDUCED, HIDDEN, MIDDLE = 512, 512, 256


class ResNet(nn.Module):
    """One image (B, 1, 3, h, w) to K numbers."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.backbone = ResNet50()
        self.weights_from = pretrained(self.backbone)
        self.backbone.fc = nn.Linear(self.backbone.fc.in_features, outputs)

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K); it sees the whole image, so `at` says nothing."""
        return self.backbone(images[:, 0])


class VggLstm(nn.Module):
    """A window (B, T, 3, h, w) to K numbers."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.backbone = Vgg19()
        self.weights_from = pretrained(self.backbone)
        self.backbone.classifier[-1] = nn.Linear(DENSE, REDUCED)
        self.memory = nn.LSTM(REDUCED, HIDDEN, num_layers=2, batch_first=True)
        self.head = nn.Sequential(nn.Linear(HIDDEN, MIDDLE), nn.ReLU(), nn.Linear(MIDDLE, outputs))

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K); it sees the whole image, so `at` says nothing."""
        batch, frames = images.shape[:2]
        features = self.backbone(images.flatten(0, 1)).reshape(batch, frames, -1)
        found, _ = self.memory(features)
        return self.head(found[:, -1])


def pretrained(network: ResNet50 | Vgg19) -> str:
    """Give a network its ImageNet weights where they are to be had; says where it got them."""
    found = _weights(f"{PLACE}/{FILES[type(network)]}")
    if found is None:
        return RANDOM
    network.load_state_dict(found)
    return IMAGENET


def _weights(address: str) -> Mapping[str, Any] | None:
    """A file of weights from the cache or the network; None where it is in neither."""
    try:
        return torch.hub.load_state_dict_from_url(
            address, map_location="cpu", progress=False, check_hash=True, weights_only=True
        )
    except (OSError, RuntimeError, pickle.UnpicklingError):
        # No way to it from here, or what came is not it.
        return None
