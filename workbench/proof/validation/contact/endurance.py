"""Memory of one process that presses again and again, while design, object and grid change.

A designer's session does this all day. Grown is the process's resident set, which also holds what
Taichi keeps on the host; on a GPU the memory of the device, which holds the arrays, is added.
The first presses compile kernels and fill caches, so growth is counted after them.
"""

from __future__ import annotations

import gc
import math
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import SEEN, UNSEEN, Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.pipeline.devices import open_device
from workbench.proof.row import Row, bounded

if TYPE_CHECKING:
    from sim.contact.readout.problem import Problem

PRESSES = 500
WARM_UP = 100
"""Presses before memory is first read: twice through all objects and grids."""
GROWTH_LIMIT_MB = 5.0
"""Growth over 100 presses: the arrays of three of them would be more."""
WIDTH_MM = 10.0
HEIGHT_MM = 2.0
GRIDS_MM = (0.5, 0.6, 0.7, 0.8)


def resident_MB() -> float:
    """Resident set of this process [MB], with the device memory that is in use; NaN if unknown."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return math.nan
    kilobytes = next((line.split()[1] for line in lines if line.startswith("VmRSS")), "nan")
    return float(kilobytes) / 1e3 + _device_MB()


def _device_MB() -> float:
    """Memory of the device that is not free [MB]; 0 on the CPU. Others may use the device too."""
    if open_device() == "cpu":
        return 0.0
    from sim.contact.engine.memory import free_bytes

    return -free_bytes() / 1e6


def varied_press(number: int) -> Problem:
    """A small press whose sensor, object, grid, material and depth all depend on its number."""
    from sim.contact.readout.problem import make_problem
    from sim.contact.studies.specimens import flat_block

    kinds = (*SEEN, *UNSEEN)
    grid_mm = GRIDS_MM[number % len(GRIDS_MM)]
    height_mm = HEIGHT_MM + 0.01 * (number % 7)
    mesh, points = flat_block(width_mm=WIDTH_MM, height_mm=height_mm, grid_mm=grid_mm, skin_mm=0.8)
    return make_problem(
        mesh,
        points,
        Elastomer(young_MPa=0.1 + 1e-4 * number),
        PressCase(
            indenter=Indenter(kind=kinds[number % len(kinds)], size_mm=4.0),
            press=Press(
                target_mm=(0.0, 0.0, height_mm), depth_mm=0.2 + 0.02 * (number % 5), frames=1
            ),
            settings=ContactSettings(grid_mm=grid_mm),
        ),
    )


def growth_MB(presses: int = PRESSES, *, warm_up: int = WARM_UP) -> float:
    """Growth of memory over each 100 presses after the first ones [MB].

    Raises:
        SolveError: If a press does not settle.
    """
    # Opened first: Taichi would otherwise announce itself on stdout when it is imported.
    open_device()
    from sim.contact.solver.solver import solve

    first_MB = 0.0
    for number in range(presses):
        if number == warm_up:
            gc.collect()
            first_MB = resident_MB()
        (result,) = solve([varied_press(number)])
        if isinstance(result, Exception):
            raise result
    gc.collect()
    return 100.0 * (resident_MB() - first_MB) / (presses - warm_up)


def row(presses: int = PRESSES) -> Row:
    """`memory_growth`."""
    return bounded(
        "memory_growth",
        f"{presses} presses in one process, each with another sensor, object, grid, material or "
        f"depth: memory taken over 100 presses, after the first {WARM_UP}",
        lambda: growth_MB(presses),
        unit="MB",
        limit=GROWTH_LIMIT_MB,
    )
