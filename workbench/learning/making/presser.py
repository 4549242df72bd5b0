"""The process that has a GPU: it settles presses that others prepared, many side by side."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

from workbench.core.base.errors import Cancelled, LaneError
from workbench.learning.making.parcels import Parcel, packed, unpacked
from workbench.pipeline.devices import VARIABLE, open_device
from workbench.system.processes import follow_parent

GPUS = "CUDA_VISIBLE_DEVICES"
"""Which GPUs the driver shows to a process."""
_stop: Any = None
"""Whether this process is to end, shared with the one that started it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pressed:
    """What a batch came to."""

    states: list[Parcel]
    """Of `PressStates`, in order."""
    seconds: float
    """Time that the batch took [s]."""
    cpu_s: float
    """Processor time of it [s]."""


def open_presser(device: str, gpu: int | None, stop: Any) -> None:
    """Make this process a presser: called once, by its pool.

    Args:
        device: `cuda` or `cpu`.
        gpu: Number of the GPU among those that are shown; None: whatever device there is.
        stop: Shared; true when this process is to end.
    """
    global _stop  # noqa: PLW0603
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    follow_parent()
    _stop = stop
    if gpu is not None:
        shown = [name for name in os.environ.get(GPUS, "").split(",") if name]
        os.environ[GPUS] = shown[gpu] if shown else str(gpu)
    os.environ[VARIABLE] = device
    open_device()


def open_here() -> None:
    """Make a process that others started a presser on the GPU that it sees."""
    global _stop  # noqa: PLW0603
    if _stop is None:
        _stop = SimpleNamespace(value=0)
        os.environ[VARIABLE] = "cuda"
        open_device()


def press_batch(problems: Sequence[Parcel]) -> Pressed:
    """Settle presses side by side.

    Args:
        problems: Parcels of `Problem`, without the membrane.

    Raises:
        Cancelled: If this process is to end.
        LaneError: If memory ran out.
    """
    from sim.contact.solver.states import States

    begun, cpu = time.perf_counter(), time.process_time()
    try:
        presses = States([unpacked(problem) for problem in problems], _watch)
        presses.run()
    except MemoryError as error:
        raise LaneError(
            f"{len(problems)} presses side by side ran out of memory",
            hint="finished samples are kept; make it again with a smaller --batch",
            at="dataset",
        ) from error
    found: list[Parcel] = [packed(states) for states in presses.states()]
    return Pressed(
        states=found, seconds=time.perf_counter() - begun, cpu_s=time.process_time() - cpu
    )


def _watch(fraction: float, note: str = "") -> None:
    if _stop.value:
        raise Cancelled("stopped", hint="make goes on where it was")
