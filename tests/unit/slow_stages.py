"""Stages that nap, do not listen, or die: imported by the lane tests in both processes."""

from __future__ import annotations

import os
import time

import numpy as np

from workbench.core.monitor import Monitor
from workbench.core.results import Picture
from workbench.stages import STAGES, Stage


def nap(seconds: float, *, monitor: Monitor) -> Picture:
    """Wait, listening."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        monitor(0.5, "napping")
        time.sleep(0.01)
    return Picture(png=np.zeros(1, np.uint8))


def deaf(seconds: float, *, monitor: Monitor) -> Picture:
    """Wait without ever asking the monitor, as a meshing library does."""
    time.sleep(seconds)
    return Picture(png=np.zeros(1, np.uint8))


def die(number: int, *, monitor: Monitor) -> Picture:
    """End this process by a signal."""
    os.kill(os.getpid(), number)
    return Picture(png=np.zeros(1, np.uint8))


for function in (nap, deaf, die):
    STAGES[function.__name__] = Stage(
        name=function.__name__, version=1, lane="cad", function=function
    )
