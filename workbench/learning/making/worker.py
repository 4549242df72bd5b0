"""A process that makes samples: what the pool calls in it."""

from __future__ import annotations

import os
import signal
from types import SimpleNamespace
from typing import Any

from workbench.core.base.errors import WorkbenchError
from workbench.learning.dataset.cases import Case
from workbench.learning.making.parcels import Parcel
from workbench.learning.making.solving import Bench
from workbench.learning.making.worker_messages import Report, SettledPress, Setup
from workbench.pipeline.devices import VARIABLE
from workbench.system.processes import follow_parent

NEVER = SimpleNamespace(value=0)
"""The wish to stop of a process that is not told of it: its case ends, and none follows."""
_bench: Bench | WorkbenchError | None = None
"""Of this worker process, or why it has none; a pool has no other place to keep it."""


def open_bench(setup: Setup, stop: Any) -> None:
    """Make this process a worker: called once, by the pool, which loses what is raised here."""
    global _bench  # noqa: PLW0603
    # Ctrl-C in a terminal reaches the whole group; the parent decides when workers stop.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    follow_parent()
    try:
        _bench = Bench(setup, stop)
    except WorkbenchError as error:
        _bench = error


def open_here(setup: Setup, device: str = "") -> None:
    """Make a process that others started a worker of a data set, unless it is one already.

    Args:
        setup: The data set.
        device: Name of the device it computes on; "" for its own.

    Raises:
        WorkbenchError: If the store lacks what its cases share.
    """
    global _bench  # noqa: PLW0603
    if isinstance(_bench, Bench) and (_bench.setup.key, _bench.setup.folder) == (
        setup.key,
        setup.folder,
    ):
        return
    if device:
        os.environ[VARIABLE] = device
    _bench = Bench(setup, NEVER)


def solve_case(case: Case) -> Report:
    """Make the samples of a case in this worker.

    Raises:
        WorkbenchError: As `Bench.solve`, or why the worker could not be opened.
    """
    return _opened().solve(case)


def prepare_case(case: Case) -> Parcel | Report:
    """Make a press ready in this worker; as `Bench.prepare`."""
    return _opened().prepare(case)


def finish_case(case: Case, problem: Parcel, pressed: SettledPress) -> Report:
    """Make the samples of a settled press in this worker; as `Bench.finish`."""
    return _opened().finish(case, problem, pressed)


def _opened() -> Bench:
    if isinstance(_bench, WorkbenchError):
        raise _bench
    assert _bench is not None
    return _bench
