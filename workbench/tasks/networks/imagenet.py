"""Two networks of ImageNet in plain layers: ResNet50, and VGG19 with batch norm.

Layers have the names that torchvision gives them, so that its files of weights fit; torchvision
itself is not asked for, as a build of it loads beside one build of PyTorch only.
Sources: He and others, Deep residual learning for image recognition, 2016, table 1, with the stride
in the middle convolution as torchvision has it; Simonyan and Zisserman, Very deep convolutional
networks, 2015, table 1 E; Ioffe and Szegedy, Batch normalization, 2015.
"""

from __future__ import annotations

import torch
from torch import Tensor, nn

BLOCKS = (3, 4, 6, 3)
"""Of each stage of ResNet50."""
WIDTHS = (64, 128, 256, 512)
"""Narrow channels of its stages; a block gives four times as many."""
WIDER = 4
VGG19 = ((64, 2), (128, 2), (256, 4), (512, 4), (512, 4))
"""Channels and convolutions of each stage; each ends by halving the image."""
POOLED_PX = 7
DENSE = 4096
IMAGENET_CLASSES = 1000


class Bottleneck(nn.Module):
    """A block of ResNet50: narrow, look around, widen, and add what came in."""

    def __init__(self, before: int, narrow: int, stride: int) -> None:
        super().__init__()
        after = WIDER * narrow
        self.conv1 = nn.Conv2d(before, narrow, 1, bias=False)
        self.bn1 = nn.BatchNorm2d(narrow)
        self.conv2 = nn.Conv2d(narrow, narrow, 3, stride=stride, padding=1, bias=False)
        self.bn2 = nn.BatchNorm2d(narrow)
        self.conv3 = nn.Conv2d(narrow, after, 1, bias=False)
        self.bn3 = nn.BatchNorm2d(after)
        self.downsample = None
        if stride > 1 or before != after:
            way = nn.Conv2d(before, after, 1, stride=stride, bias=False)
            self.downsample = nn.Sequential(way, nn.BatchNorm2d(after))

    def forward(self, images: Tensor) -> Tensor:
        """Channels (B, C, h, w), shape (B, 4 narrow, h / stride, w / stride)."""
        found = torch.relu(self.bn1(self.conv1(images)))
        found = torch.relu(self.bn2(self.conv2(found)))
        found = self.bn3(self.conv3(found))
        return torch.relu(found + (images if self.downsample is None else self.downsample(images)))


class ResNet50(nn.Module):
    """Images (B, 3, h, w) to the numbers of `fc`, in place of which one's own may be put."""

    def __init__(self) -> None:
        super().__init__()
        self.conv1 = nn.Conv2d(3, WIDTHS[0], 7, stride=2, padding=3, bias=False)
        self.bn1 = nn.BatchNorm2d(WIDTHS[0])
        self.maxpool = nn.MaxPool2d(3, stride=2, padding=1)
        before = WIDTHS[0]
        for number, (blocks, narrow) in enumerate(zip(BLOCKS, WIDTHS, strict=True)):
            stage = []
            for block in range(blocks):
                stage.append(Bottleneck(before, narrow, 2 if number and not block else 1))
                before = WIDER * narrow
            self.add_module(f"layer{number + 1}", nn.Sequential(*stage))
        self.fc = nn.Linear(before, IMAGENET_CLASSES)

    def forward(self, images: Tensor) -> Tensor:
        """Numbers, shape (B, K)."""
        found = self.maxpool(torch.relu(self.bn1(self.conv1(images))))
        for number in range(len(BLOCKS)):
            found = self.get_submodule(f"layer{number + 1}")(found)
        return self.fc(found.mean(dim=(2, 3)))


class Vgg19(nn.Module):
    """Images (B, 3, h, w) to the numbers of the last of `classifier`."""

    def __init__(self) -> None:
        super().__init__()
        layers: list[nn.Module] = []
        before = 3
        for channels, convolutions in VGG19:
            for _ in range(convolutions):
                layers.append(nn.Conv2d(before, channels, 3, padding=1))
                layers += [nn.BatchNorm2d(channels), nn.ReLU(inplace=True)]
                before = channels
            layers.append(nn.MaxPool2d(2))
        self.features = nn.Sequential(*layers)
        self.avgpool = nn.AdaptiveAvgPool2d(POOLED_PX)
        self.classifier = nn.Sequential(
            nn.Linear(before * POOLED_PX**2, DENSE),
            nn.ReLU(inplace=True),
            nn.Dropout(),
            nn.Linear(DENSE, DENSE),
            nn.ReLU(inplace=True),
            nn.Dropout(),
            nn.Linear(DENSE, IMAGENET_CLASSES),
        )

    def forward(self, images: Tensor) -> Tensor:
        """Numbers, shape (B, K)."""
        return self.classifier(self.avgpool(self.features(images)).flatten(1))
