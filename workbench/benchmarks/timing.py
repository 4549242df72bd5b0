"""Medians of repeated runs, and the results that several benchmarks start from."""

from __future__ import annotations

import functools
import statistics
import time
from collections.abc import Callable
from typing import Any

from workbench.core.design import Layers, Meshing
from workbench.core.monitor import silent
from workbench.core.results import MaterialPoints, MembraneMesh, Solid
from workbench.rows import Row, bounded
from workbench.stages import build, lattice, mesh

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


@functools.cache
def finger_solid() -> Solid:
    """The default finger."""
    from designs.family import resolve_shape

    return build("finger", resolve_shape("finger", {}), Layers(), monitor=silent)


@functools.cache
def finger_mesh() -> MembraneMesh:
    """The default finger at 0.4 mm."""
    return mesh(finger_solid(), Meshing(), monitor=silent)


@functools.cache
def finger_points(grid_mm: float = 0.5) -> MaterialPoints:
    """Material points of the default finger."""
    return lattice(finger_solid(), grid_mm, monitor=silent)
