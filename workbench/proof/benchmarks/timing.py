"""Medians of repeated runs, as rows."""

from __future__ import annotations

import statistics
import time
from collections.abc import Callable
from typing import Any

from workbench.proof.row import Row, bounded

RUNS = 5


def median_s(function: Callable[[], Any], *, runs: int = RUNS) -> float:
    """Median wall time of a call after one warm-up [s]."""
    function()
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        function()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def timed_row(
    name: str, case: str, function: Callable[[], Any], limit_s: float, *, runs: int = RUNS
) -> Row:
    """A row with the median time of a call and its limit."""
    return bounded(name, case, lambda: median_s(function, runs=runs), unit="s", limit=limit_s)
