"""Memory of a press, estimated before anything is allocated."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import taichi as ti
from taichi.lang.impl import current_cfg

from sim.contact.engine.batch import needed_bytes
from workbench.core.base.errors import DesignError
from workbench.core.result.results import MaterialPoints

USABLE_SHARE = 0.8
"""Share of the free memory that a press may take: other results need some."""
POINTS_PER_CELL = 0.5
"""Surface points for each cell, at most: a thin wall at the finest refinement."""
HOST_FACTOR = 2.0
"""The arrays exist once more on the host while they are made."""


def check_memory(points: MaterialPoints, target_mm: np.ndarray, radius_mm: float) -> None:
    """Refuse a press that does not fit.

    Raises:
        DesignError: With what is needed and what is free.
    """
    distance = np.linalg.norm(points.cells * points.grid_mm - target_mm, axis=1)
    cells = int(np.count_nonzero(distance < radius_mm))
    needed = HOST_FACTOR * needed_bytes(cells, int(POINTS_PER_CELL * cells))
    free = free_bytes()
    if needed > USABLE_SHARE * free:
        raise DesignError(
            f"{8 * cells / 1e6:.1f} million particles need {needed / 2**30:.1f} GiB; "
            f"{USABLE_SHARE * free / 2**30:.1f} GiB of memory may be used",
            hint="raise contact.grid_mm, or lower contact.active_radius_mm",
            at="contact.grid_mm",
        )


def free_bytes() -> float:
    """Free memory of the device that computes; infinite where it cannot be told."""
    return _cuda_free_bytes() if current_cfg().arch == ti.cuda else _host_free_bytes()


def _host_free_bytes() -> float:
    try:
        lines = Path("/proc/meminfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        return float("inf")
    kilobytes = next((line.split()[1] for line in lines if line.startswith("MemAvailable")), None)
    return float("inf") if kilobytes is None else 1024.0 * float(kilobytes)


def _cuda_free_bytes() -> float:
    driver = ctypes.CDLL("libcuda.so.1")
    context, free, total = ctypes.c_void_p(), ctypes.c_size_t(), ctypes.c_size_t()
    if driver.cuDevicePrimaryCtxRetain(ctypes.byref(context), 0) != 0:
        return float("inf")
    driver.cuCtxPushCurrent_v2(context)
    answer = driver.cuMemGetInfo_v2(ctypes.byref(free), ctypes.byref(total))
    driver.cuCtxPopCurrent_v2(ctypes.byref(context))
    return float(free.value) if answer == 0 else float("inf")
