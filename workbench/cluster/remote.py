"""What runs in the workers of a cluster: one call of a stage, its progress, its end."""

from __future__ import annotations

import contextlib
import functools
import tempfile
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from workbench.cluster.shipped import packed, unpacked
from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.core.base.monitor import Monitor
from workbench.core.base.version import VERSION
from workbench.pipeline.stage import Call, Outcome, Ref
from workbench.pipeline.store import Store
from workbench.planning.running import run

REPORT_S = 0.5
"""Time between two reports to the scheduler, each of which also asks whether to stop [s]."""
PROGRESS = "workbench progress"
"""The topic of reports."""


def version() -> str:
    """Of the program that this worker runs."""
    return VERSION


def sees(path: str) -> bool:
    """Whether a file of the one who asks is there."""
    return Path(path).exists()


def run_call(root: str, call: Call, name: str) -> Outcome:
    """Compute a call in a store that this worker shares with the one who asks.

    Args:
        root: Folder of the store.
        call: The call.
        name: That of the task: progress is told, and stopping is asked for, by it.

    Raises:
        Cancelled: If the one who asked does not wait any more.
        WorkbenchError: Whatever the stage raises.
    """
    return run(Store(Path(root)), call, _monitor(name))


def run_call_alone(
    call: Call, name: str, inputs: Mapping[tuple[str, str], bytes]
) -> tuple[Outcome, bytes]:
    """Compute a call in a store of this worker's own; returns its result too.

    Args:
        call: The call.
        name: As for `run_call`.
        inputs: Stored results that it reads, by stage and key.
    """
    store = own_store()
    for (stage, key), content in inputs.items():
        unpacked(store, Ref(stage=stage, key=key), content)
    outcome = run(store, call, _monitor(name))
    return outcome, packed(store, call.ref)


@functools.cache
def _own_folder() -> tempfile.TemporaryDirectory[str]:
    return tempfile.TemporaryDirectory(prefix="workbench-")


def own_store() -> Store:
    """The store of a worker that shares none, gone with its process."""
    return Store(Path(_own_folder().name))


def _monitor(name: str) -> Monitor:
    """Reports to the scheduler; raises once the event of the task is set."""
    from distributed import Event, get_worker

    worker = get_worker()
    stop = Event(_stop_name(name))
    last = time.monotonic()

    def monitor(fraction: float, note: str = "") -> None:
        nonlocal last
        now = time.monotonic()
        if now - last < REPORT_S:
            return
        last = now
        worker.log_event(PROGRESS, {"task": name, "fraction": float(fraction), "note": note})
        if stop.is_set():
            raise Cancelled("cancelled by the user")

    return monitor


def stop(client: Any, name: str) -> None:
    """Ask a task to end at its next report; runs where the client is."""
    from distributed import Event

    with contextlib.suppress(OSError, WorkbenchError):
        Event(_stop_name(name), client=client).set()


def _stop_name(name: str) -> str:
    return f"stop {name}"
