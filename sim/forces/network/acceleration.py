"""A fixed computation on a CUDA device, with fewer launches: compiled, recorded, or as it is.

A frame of the network is some hundred small kernels, whose launches take longer than their work. A
CUDA graph replays them in one launch; a compiler merges them first. Each way that a machine lacks
(a compiler needs Triton and a C compiler) gives way to the next slower one, and says so.

Left out: the CPU, where launches cost little and merging gains nothing that was measured.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable
from enum import StrEnum

import torch
from torch import Tensor

Computation = Callable[[Tensor], Tensor]
MOST_COMPILED = 10_000
"""Membranes and batch sizes of a process: no limit in practice."""
WARMING = 3
"""Runs before the recording: libraries choose their algorithms and take their memory."""


class Acceleration(StrEnum):
    """How the kernels of a frame are launched."""

    AUTO = "auto"
    """`COMPILED` on a CUDA device, `EAGER` elsewhere."""
    EAGER = "eager"
    """One by one."""
    GRAPH = "graph"
    """Recorded once as a CUDA graph."""
    COMPILED = "compiled"
    """Merged by the compiler, which takes a minute the first time, then recorded."""


def accelerated(
    function: Computation, example: Tensor, *, acceleration: Acceleration
) -> tuple[Computation, Acceleration, str]:
    """A function with the same results for arguments of the same shape.

    The result of a recorded function is overwritten by its next call.

    Args:
        function: Of tensors on a device; what else it reads must stay where it is.
        example: An argument.
        acceleration: What is wanted.

    Returns:
        The function, what was possible, and a note for the user where that is less, else "".

    Raises:
        torch.OutOfMemoryError: If the device has no room for it.
    """
    if acceleration is Acceleration.AUTO:
        acceleration = Acceleration.COMPILED
    if example.device.type != "cuda" or acceleration is Acceleration.EAGER:
        return function, Acceleration.EAGER, ""
    note = ""
    if acceleration is Acceleration.COMPILED:
        try:
            return _recorded(_compiled(function, example), example), acceleration, ""
        except torch.OutOfMemoryError:
            raise
        except RuntimeError as error:
            note = f"the network runs uncompiled: {_first_line(error)}"
    try:
        return _recorded(function, example), Acceleration.GRAPH, note
    except torch.OutOfMemoryError:
        raise
    except RuntimeError as error:
        note = f"the network runs kernel by kernel: {_first_line(error)}"
    return function, Acceleration.EAGER, note


def _compiled(function: Computation, example: Tensor) -> Computation:
    """The function with its kernels merged, for the shape of the example."""
    from torch._dynamo import config

    result = torch.compile(function, dynamic=False)
    # All membranes and batch sizes of a process share the function's code; after eight of them
    # PyTorch would go on uncompiled and tell nobody but its log.
    with (
        config.patch(recompile_limit=MOST_COMPILED, accumulated_recompile_limit=MOST_COMPILED),
        warnings.catch_warnings(),
    ):
        # Full float32 is asked for on purpose, to evaluate with.
        warnings.filterwarnings("ignore", message="TensorFloat32")
        result(example)
    return result


def _first_line(error: Exception) -> str:
    return str(error).strip().split("\n", maxsplit=1)[0][:200]


def _recorded(function: Computation, example: Tensor) -> Computation:
    """The function as a CUDA graph over fixed places in memory."""
    given = example.clone()
    stream = torch.cuda.Stream()
    stream.wait_stream(torch.cuda.current_stream())
    with torch.cuda.stream(stream):
        for _ in range(WARMING):
            function(given)
    torch.cuda.current_stream().wait_stream(stream)
    graph = torch.cuda.CUDAGraph()
    # Other threads of the process may use the device meanwhile, as the contact solver does.
    with torch.cuda.graph(graph, capture_error_mode="thread_local"):
        result = function(given)

    def replay(argument: Tensor) -> Tensor:
        given.copy_(argument)
        graph.replay()
        return result

    return replay
