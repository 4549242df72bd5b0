"""A network of our own: seven convolutions from random weights, for single images.

Each block halves the image; what it has found is averaged over the image, so that a contact counts
wherever it is, and the mean place of each channel is kept beside it, which says where. Source of
the second: Levine and others, End-to-end training of deep visuomotor policies, 2016 (spatial
softmax). Where it is shown, and how strong it is, come in last.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

from workbench.tasks.networks.shown import PLACE

CHANNELS = (24, 48, 64, 96)
HIDDEN = 64
DROPOUT = 0.2


class Eye(nn.Module):
    """Features of an image (B, 3, h, w): maxima, means and places of channels."""

    def __init__(self) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        before = 3
        for number, channels in enumerate(CHANNELS):
            layers += _block(before, channels, stride=2)
            if number:
                layers += _block(channels, channels, stride=1)
            before = channels
        self.layers = nn.Sequential(*layers)
        self.features = 4 * before

    def forward(self, images: Tensor) -> Tensor:
        """Features, shape (B, 4 C)."""
        found = self.layers(images)
        batch, channels, height, width = found.shape
        shares = torch.softmax(found.reshape(batch, channels, -1), dim=2)
        shares = shares.reshape(batch, channels, height, width)
        down = torch.linspace(-1.0, 1.0, height, device=found.device)
        across = torch.linspace(-1.0, 1.0, width, device=found.device)
        return torch.cat(
            [
                found.amax(dim=(2, 3)),
                found.mean(dim=(2, 3)),
                (shares.sum(dim=3) * down).sum(dim=2),
                (shares.sum(dim=2) * across).sum(dim=2),
            ],
            dim=1,
        )


def _block(before: int, after: int, *, stride: int) -> list[nn.Module]:
    convolution = nn.Conv2d(before, after, 3, stride=stride, padding=1, bias=False)
    return [convolution, nn.BatchNorm2d(after), nn.ReLU()]


class OwnNet(nn.Module):
    """One image (B, 1, 3, h, w) to K numbers."""

    def __init__(self, outputs: int) -> None:
        super().__init__()
        self.eye = Eye()
        self.head = nn.Sequential(
            nn.Dropout(DROPOUT),
            nn.Linear(self.eye.features + PLACE, HIDDEN),
            nn.ReLU(),
            nn.Linear(HIDDEN, outputs),
        )

    def forward(self, images: Tensor, at: Tensor) -> Tensor:
        """Numbers, shape (B, K), with where and how strong it is, (B, 8)."""
        return self.head(torch.cat([self.eye(images[:, 0]), at], dim=1))
