"""A process that makes samples: what the pool calls in it."""

from __future__ import annotations

import os
import signal
from collections.abc import Sequence
from multiprocessing import current_process
from typing import Any

from workbench.core.base.errors import WorkbenchError
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.solving import Bench
from workbench.learning.dataset.worker_messages import Report, Setup
from workbench.pipeline.devices import cuda_count
from workbench.system.processes import follow_parent

GPUS = "CUDA_VISIBLE_DEVICES"
"""Which GPUs the driver shows to this process; what a user has set stays."""
_bench: Bench | WorkbenchError | None = None
"""Of this worker process, or why it has none; a pool has no other place to keep it."""


def open_bench(setup: Setup, stop: Any) -> None:
    """Make this process a worker: called once, by the pool, which loses what is raised here."""
    global _bench  # noqa: PLW0603
    # Ctrl-C in a terminal reaches the whole group; the parent decides when workers stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    follow_parent()
    _choose_gpu()
    try:
        _bench = Bench(setup, stop)
    except WorkbenchError as error:
        _bench = error


def _choose_gpu() -> None:
    """Let workers share out the GPUs among them, in the order in which they were started."""
    count = cuda_count()
    if count > 1 and GPUS not in os.environ:
        # A process of a pool is named by its number, and a queue would have a lock to die with.
        number = int(current_process().name.rsplit("-", 1)[-1])
        os.environ[GPUS] = str(number % count)


def solve_cases(cases: Sequence[Case]) -> list[Report]:
    """Make the samples of some cases in this worker.

    Raises:
        WorkbenchError: As `Bench.solve`, or why the worker could not be opened.
    """
    if isinstance(_bench, WorkbenchError):
        raise _bench
    assert _bench is not None
    return _bench.solve(cases)
