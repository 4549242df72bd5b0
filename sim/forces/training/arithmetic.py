"""In which type a step is computed, by what rule weights move, and when a device is full."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator

import torch
from torch import nn

from sim.forces.training.settings import Numbers, TrainingSettings
from workbench.core.base.errors import DeviceError

FULL = ("out of memory", "can't allocate memory", "ALLOC_FAILED")
"""In messages of errors that have no type of their own: of the CPU, and of libraries on a GPU."""


def half_type(device: str, numbers: Numbers) -> torch.dtype | None:
    """The short type of a step, None for float32."""
    if numbers is Numbers.SINGLE or (numbers is Numbers.AUTO and device == "cpu"):
        return None
    if device == "cpu" or torch.cuda.is_bf16_supported(including_emulation=False):
        return torch.bfloat16
    return torch.float16


def adam(network: nn.Module, settings: TrainingSettings, *, fused: bool) -> torch.optim.Optimizer:
    """Adam; the weights of products decay where asked, shifts and scales do not."""
    trained = [p for p in network.parameters() if p.requires_grad]
    matrices = [p for p in trained if p.ndim > 1]
    vectors = [p for p in trained if p.ndim < 2]
    groups = [
        {"params": matrices, "weight_decay": settings.weight_decay},
        {"params": vectors, "weight_decay": 0.0},
    ]
    return torch.optim.AdamW(groups, lr=settings.rate, fused=fused)


def is_full(error: RuntimeError) -> bool:
    """Whether an error says that a device has no memory left."""
    return isinstance(error, torch.OutOfMemoryError) or any(word in str(error) for word in FULL)


@contextlib.contextmanager
def room_for(device: str) -> Iterator[None]:
    """Raises the error below where the device is full."""
    try:
        yield
    except RuntimeError as error:
        if not is_full(error):
            raise
        raise no_room(device) from error


def no_room(device: str) -> DeviceError:
    """The error that says so to people."""
    return DeviceError(
        f"the {device} device has no memory left, even for one sample at a time",
        hint="the last checkpoint is kept; close what else uses the device and go on with the same "
        "command, or set WORKBENCH_DEVICE=cpu",
        at="device",
    )
