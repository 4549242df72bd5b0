"""Threads of a block of each pass of a substep on a GPU: what its registers leave room for.

Taichi compiles a pass so that two blocks fit on a multiprocessor, of 65,536 registers: more threads
in a block leave fewer registers to each, and let more of them wait for memory at the same time.
"""

from __future__ import annotations

import taichi as ti
from taichi.lang.impl import current_cfg

CELL_THREADS = 256
"""128 registers a thread: all values of a cell, without a spill."""
NODE_THREADS = 512
"""64 registers a thread: hardly anything is computed."""


def block_size(threads: int) -> int | None:
    """Threads of a block on a GPU; None, as Taichi has it, on a CPU, where it means another thing.

    A kernel asks while it is compiled.
    """
    return threads if current_cfg().arch == ti.cuda else None
