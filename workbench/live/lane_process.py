"""What runs in the process of a lane: one call after the other, its progress, its errors.

The process imports what its calls need before the first one comes, and ends with its parent.
"""

from __future__ import annotations

import contextlib
import importlib
import os
import signal
import time
import traceback
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from workbench.core.base.errors import Cancelled, LaneError, WorkbenchError
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.live.preview_call import PreviewCall
from workbench.pipeline.stage import Call
from workbench.pipeline.store import Store
from workbench.planning.running import run
from workbench.system.processes import follow_parent

REPORT_S = 0.05
"""Shortest time between two progress messages [s]."""
IDLE_S = 3.0
"""A simulation lane without a job for so long gets ready for its first press [s]."""


def serve(name: str, modules: Sequence[str], root: Path, pipe: Connection, cancelled: Any) -> None:
    """Main loop of a worker process."""
    # Ctrl-C in a terminal reaches the whole group; the parent decides when a lane stops.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    os.environ.setdefault("ENABLE_TAICHI_HEADER_PRINT", "0")
    follow_parent()
    unready = _warm_up(name, modules)
    store, kept = Store(root), {}
    if name == "sim" and unready is None and not pipe.poll(IDLE_S):
        _rehearse()
    while True:
        try:
            number, call = pipe.recv()
        except EOFError:
            return
        # What was missing may have been installed since.
        unready = unready and _warm_up(name, modules)
        monitor = _reporter(pipe, cancelled, number)
        answer = ("error", unready) if unready else _answer(store, kept, call, monitor)
        pipe.send((number, *answer))


def _warm_up(name: str, modules: Sequence[str]) -> LaneError | None:
    """Import what the jobs need; an error to answer them with where that fails."""
    for module in modules:
        try:
            importlib.import_module(module)
        except Exception as error:
            text = "".join(traceback.format_exception(error))
            return LaneError(
                f"the {name} process cannot import {module}: {error!r}",
                hint=f"run workbench doctor to see what is missing\n{text}",
                at=name,
            )
    return None


def _rehearse() -> None:
    """Press a small block: loading the solver's kernels takes seconds that no designer need see."""
    from sim.contact.press import press_membrane
    from sim.contact.studies.specimens import flat_block
    from workbench.pipeline.devices import open_device

    block = flat_block(width_mm=8.0, height_mm=2.0, grid_mm=0.5)
    path = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.05, frames=1)
    open_device()
    # What fails here fails again in the first press, which reports it.
    with contextlib.suppress(WorkbenchError, RuntimeError):
        press_membrane(*block, Elastomer(), PressCase(press=path))


def _answer(
    store: Store, kept: dict[str, Any], call: Call | PreviewCall, monitor: Monitor
) -> tuple[str, Any]:
    try:
        if isinstance(call, Call):
            return "done", run(store, call, monitor)
        return "done", call.answer(store, kept, monitor)
    except WorkbenchError as error:
        return "error", error
    except MemoryError:
        return "error", LaneError(
            f"{call.stage} ran out of memory", hint="use a coarser mesh or grid", at=call.stage
        )
    except Exception as error:
        # A bug: the traceback must reach the log of the server, which writes the crash file.
        text = "".join(traceback.format_exception(error))
        return "error", LaneError(f"{call.stage} failed: {error!r}", hint=text, at=call.stage)


def _reporter(pipe: Connection, cancelled: Any, number: int) -> Callable[..., None]:
    last = 0.0

    def monitor(fraction: float, note: str = "") -> None:
        nonlocal last
        if cancelled.value == number:
            raise Cancelled("cancelled by the user")
        now = time.monotonic()
        if now - last >= REPORT_S:
            last = now
            pipe.send((number, "progress", (fraction, note)))

    return monitor
