"""A process that makes samples: what the pool calls in it."""

from __future__ import annotations

import signal
from typing import Any

from workbench.core.base.errors import WorkbenchError
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.solving import Bench, Report, Setup
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
    if isinstance(_bench, WorkbenchError):
        raise _bench
    assert _bench is not None
    return _bench.solve(case)
