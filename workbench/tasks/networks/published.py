"""The paper's networks: ResNet50 for single images, VGG19 and an LSTM for windows.

They come from torchvision. Their ImageNet weights are in no package: where the cache of PyTorch
(`torch.hub`) has the files they are used, else they are fetched if the machine may, else the
networks begin at random weights, and results say so.
Source of the layers behind VGG: the released script, 4096 -> 512 -> LSTM of two layers, 512 -> 256
-> classes.
"""

from __future__ import annotations

from typing import Any

from torch import Tensor, nn

IMAGENET, RANDOM = "ImageNet weights of torchvision", "random weights"
VGG_FEATURES, REDUCED, HIDDEN = 4096, 512, 512
MIDDLE = 256


class ResNet(nn.Module):
    """One image (B, 1, 3, h, w) to K numbers."""

    def __init__(self, outputs: int, *, pretrained: bool) -> None:
        super().__init__()
        from torchvision.models import ResNet50_Weights, resnet50  # pyright: ignore[reportMissingImports]

        weights = ResNet50_Weights.IMAGENET1K_V2 if pretrained else None
        self.backbone: Any = resnet50(weights=weights)
        self.backbone.fc = nn.Linear(self.backbone.fc.in_features, outputs)

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K); it sees the whole image, so `at` says nothing."""
        return self.backbone(images[:, 0])


class VggLstm(nn.Module):
    """A window (B, T, 3, h, w) to K numbers."""

    def __init__(self, outputs: int, *, pretrained: bool) -> None:
        super().__init__()
        from torchvision.models import VGG19_BN_Weights, vgg19_bn  # pyright: ignore[reportMissingImports]

        weights = VGG19_BN_Weights.IMAGENET1K_V1 if pretrained else None
        self.backbone: Any = vgg19_bn(weights=weights)
        self.backbone.classifier[-1] = nn.Linear(VGG_FEATURES, REDUCED)
        self.memory = nn.LSTM(REDUCED, HIDDEN, num_layers=2, batch_first=True)
        self.head = nn.Sequential(nn.Linear(HIDDEN, MIDDLE), nn.ReLU(), nn.Linear(MIDDLE, outputs))

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K); it sees the whole image, so `at` says nothing."""
        batch, frames = images.shape[:2]
        features = self.backbone(images.flatten(0, 1)).reshape(batch, frames, -1)
        found, _ = self.memory(features)
        return self.head(found[:, -1])


def resnet(outputs: int) -> tuple[nn.Module, str]:
    """ResNet50, and where its weights come from."""
    return _pretrained(ResNet, outputs)


def vgg_lstm(outputs: int) -> tuple[nn.Module, str]:
    """VGG19 and LSTM, and where the weights of the first come from."""
    return _pretrained(VggLstm, outputs)


def _pretrained(kind: Any, outputs: int) -> tuple[nn.Module, str]:
    try:
        return kind(outputs, pretrained=True), IMAGENET
    except OSError:
        # Neither in the cache nor to be had from here.
        return kind(outputs, pretrained=False), RANDOM
