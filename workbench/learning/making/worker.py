"""A process that makes samples: what the pool calls in it."""

from __future__ import annotations

import signal
from typing import Any

from workbench.core.base.errors import WorkbenchError
from workbench.learning.dataset.cases import Case
from workbench.learning.making.solving import Bench
from workbench.learning.making.worker_messages import Report, SettledPress, Setup
from workbench.system.processes import follow_parent

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


def solve_case(case: Case) -> Report:
    """Make the samples of a case in this worker.

    Raises:
        WorkbenchError: As `Bench.solve`, or why the worker could not be opened.
    """
    return _opened().solve(case)


def prepare_case(case: Case) -> bytes | Report:
    """Make a press ready in this worker; as `Bench.prepare`."""
    return _opened().prepare(case)


def finish_case(case: Case, problem: bytes, pressed: SettledPress) -> Report:
    """Make the samples of a settled press in this worker; as `Bench.finish`."""
    return _opened().finish(case, problem, pressed)


def _opened() -> Bench:
    if isinstance(_bench, WorkbenchError):
        raise _bench
    assert _bench is not None
    return _bench
