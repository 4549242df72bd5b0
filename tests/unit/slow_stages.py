"""Stages that nap, do not listen, die, or compile: imported by the lane tests in both processes."""

from __future__ import annotations

import os
import time
from dataclasses import dataclass

import numpy as np

from workbench.core.base.monitor import Monitor
from workbench.core.result.results import Picture
from workbench.pipeline.stage import Call, Stage
from workbench.planning.stage_table import STAGES


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


def compile_one(number: int, *, monitor: Monitor) -> Picture:
    """Run a kernel that no other process has compiled."""
    from workbench.pipeline.devices import open_device

    open_device()
    import taichi as ti

    values = ti.field(ti.i32, shape=1)

    @ti.kernel
    def fill():
        values[0] = number

    fill()
    return Picture(png=np.full(1, values[0], np.uint8))


@dataclass(frozen=True, kw_only=True, slots=True)
class Inputs:
    """What these stages read."""

    value: float | str


for function in (nap, deaf, die, compile_one):
    STAGES[function.__name__] = Stage(
        name=function.__name__,
        label=function.__name__,
        version=1,
        place=100,
        lane="cad",
        run=lambda given, *, monitor, function=function: function(given.value, monitor=monitor),
    )


def call_of(name: str, value: float | str) -> Call:
    """A call of one of them."""
    return STAGES[name].call(Inputs(value=value))
