"""Worker processes that can be killed: the only safe home for meshing, CAD and solvers.

Some libraries hold the interpreter for minutes and cannot be interrupted, so heavy work runs in a
*lane*: one spawned process that executes one call at a time. A soft cancel makes the stage's next
`monitor` call raise `Cancelled`; after `GRACE_S` the process is killed and a new one takes its
place. Results travel through the store, never through the pipe; only previews
(`workbench.live.preview_call`), which are not kept, are sent back as they are.
"""

from __future__ import annotations

import contextlib
import importlib
import itertools
import multiprocessing
import os
import signal
import threading
import time
import traceback
from collections.abc import Callable, Sequence
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

from workbench.core.base.errors import Cancelled, LaneError, WorkbenchError
from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.live.preview_call import PreviewCall
from workbench.pipeline.stage import Call, Outcome
from workbench.pipeline.store import Store
from workbench.planning.running import run
from workbench.planning.stage_table import STAGES

GRACE_S = 2.0
"""Time a stage has to notice a cancel before its process is killed [s]."""
PREVIEW_GRACE_S = 20.0
"""The same of a live press: it is stopped at every move, and its first one loads kernels [s]."""
GOODBYE_S = 2.0
"""Time that workers without a job have to end by themselves when the workbench closes [s]."""
REPORT_S = 0.05
"""Shortest time between two progress messages [s]."""
WARM_UP = {
    "cad": ("designs.finger", "geometry.body.solid", "build123d", "manifold3d", "embreex"),
    "sim": ("sim.contact.solver.solver", "sim.optics.studio.render", "embreex", "scipy.ndimage"),
    "look": (
        "sim.optics.studio.render",
        "workbench.planning.misfits",
        "geometry.body.solid",
        "manifold3d",
        "embreex",
    ),
}
"""What each lane imports before its first job, so that the first click is warm.

`cad` shapes and meshes, `sim` presses and renders, `look` answers what follows the designer's hand
while the other two are busy.
"""
IDLE_S = 3.0
"""A simulation lane without a job for so long gets ready for its first press [s]."""


class Lane:
    """One worker process; `run` blocks the calling thread until the call is done."""

    def __init__(self, name: str, store: Store) -> None:
        self.name = name
        self.store = store
        self._context = multiprocessing.get_context("spawn")
        # Without a lock: a worker killed while it holds one would block this process for ever.
        self._cancelled = self._context.RawValue("q", -1)
        self._turn = threading.Lock()
        self._numbers = itertools.count()
        self._closed = False
        self._start()

    def _start(self) -> None:
        self._pipe, child = self._context.Pipe()
        self._process = self._context.Process(
            target=_serve,
            args=(self.name, WARM_UP[self.name], self.store.root, child, self._cancelled),
            name=f"workbench-{self.name}",
            daemon=True,
        )
        self._process.start()
        child.close()
        if self._closed:
            self._process.kill()

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Execute a call in the worker, one at a time.

        Raises:
            Cancelled: If the monitor raised it, or the lane was closed.
            LaneError: If the process ended by itself, or could not be made ready.
            WorkbenchError: Whatever the stage raised.
        """
        return self._in_turn(call, monitor, GRACE_S)

    def preview(self, call: PreviewCall, monitor: Monitor) -> Any:
        """Execute a preview's call in the worker, in turn with the others; raises as `run`."""
        return self._in_turn(call, monitor, PREVIEW_GRACE_S)

    def _in_turn(self, call: Call | PreviewCall, monitor: Monitor, grace_s: float) -> Any:
        while not self._turn.acquire(timeout=0.1):
            monitor(0.0, f"waiting for the {self.name} worker")
        try:
            return self._run(call, monitor, grace_s)
        finally:
            self._turn.release()

    def _run(self, call: Call | PreviewCall, monitor: Monitor, grace_s: float) -> Any:
        if self._closed:
            raise Cancelled("the workbench is closing")
        if not self._process.is_alive():
            self._start()
        number = next(self._numbers)
        asked: float | None = None
        fraction, note = 0.0, ""
        try:
            self._pipe.send((number, call))
        except OSError:
            raise self._ended(asked) from None
        while True:
            reply = self._reply(number, asked)
            if reply is not None:
                kind, value = reply
                if kind == "done":
                    return value
                if kind == "error":
                    raise value
                fraction, note = value
            if asked is None:
                try:
                    monitor(fraction, note)
                except Cancelled:
                    asked = time.monotonic()
                    self._cancelled.value = number
                except BaseException:
                    # The caller is lost, and its job must not hold up the next one.
                    self._kill()
                    raise
            elif time.monotonic() - asked > grace_s:
                self._kill()
                raise Cancelled(f"{call.stage} was stopped", hint="run it again when ready")

    def _reply(self, number: int, asked: float | None) -> tuple[str, Any] | None:
        """The next message about a job, if one comes soon; those of other jobs are dropped."""
        try:
            if self._pipe.poll(0.05):
                answered, kind, value = self._pipe.recv()
                if answered == number:
                    return kind, value
        except (EOFError, OSError):
            raise self._ended(asked) from None
        return None

    def _ended(self, asked: float | None) -> WorkbenchError:
        self._process.join(1.0)
        code = self._process.exitcode
        self._kill()
        if asked is not None or self._closed:
            return Cancelled("stopped")
        how = f"signal {-code}" if code is not None and code < 0 else f"exit status {code}"
        return LaneError(
            f"the {self.name} process ended ({how})",
            hint="it was started again; finished results are kept, so run once more. If it "
            "repeats, the machine may be out of memory: use a coarser mesh or grid",
            at=self.name,
        )

    def _kill(self) -> None:
        self._process.kill()
        self._process.join(1.0)
        self._pipe.close()
        if not self._closed:
            self._start()

    def hang_up(self) -> None:
        """Let a worker without a job end by itself: only so does Taichi keep what it compiled."""
        self._closed = True
        if self._turn.acquire(blocking=False):
            try:
                self._pipe.close()
            finally:
                self._turn.release()

    def close(self, wait_s: float = 0.0) -> None:
        """End the process, by itself or not; a running call raises `Cancelled`."""
        self._closed = True
        self._process.join(wait_s)
        self._process.kill()
        self._process.join(1.0)


class LaneRunner:
    """Runs each call in the lane its stage names; stored results do not leave this process."""

    def __init__(self, store: Store) -> None:
        self.store = store
        self.lanes = {name: Lane(name, store) for name in WARM_UP}

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call in its lane unless it is stored."""
        if self.store.has(call.stage, call.key):
            return Outcome(stage=call.stage, key=call.key, cached=True, seconds=0.0)
        return self.lanes[STAGES[call.stage].lane].run(call, monitor)

    def preview(self, call: PreviewCall, monitor: Monitor) -> Any:
        """Compute a preview in the lane it names; nothing is stored."""
        return self.lanes[call.lane].preview(call, monitor)

    def close(self) -> None:
        """End all worker processes."""
        for lane in self.lanes.values():
            lane.hang_up()
        latest = time.monotonic() + GOODBYE_S
        for lane in self.lanes.values():
            lane.close(max(latest - time.monotonic(), 0.0))


def _serve(name: str, modules: Sequence[str], root: Path, pipe: Connection, cancelled: Any) -> None:
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
        press_membrane(*block, Elastomer(), Indenter(), path, ContactSettings())


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


def follow_parent() -> None:
    """Leave no orphan: end this process when the server dies, whatever it is doing.

    The kernel's own signal ends it where that can be had: a thread gets no turn while a CAD kernel
    computes with Python's lock held.
    """
    parent = multiprocessing.parent_process()
    if parent is None:
        return
    with contextlib.suppress(ImportError, AttributeError, OSError, ValueError):
        import fcntl

        # What nobody writes to any more tells its reader, by SIGIO, whose default action is to end.
        signal.signal(signal.SIGIO, signal.SIG_DFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETOWN, os.getpid())
        flags = fcntl.fcntl(parent.sentinel, fcntl.F_GETFL)
        fcntl.fcntl(parent.sentinel, fcntl.F_SETFL, flags | os.O_ASYNC)

    def watch() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=watch, daemon=True).start()
