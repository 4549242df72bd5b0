"""Worker processes that can be killed: the only safe home for meshing, CAD and solvers.

Some libraries hold the interpreter for minutes and cannot be interrupted, so heavy work runs in a
*lane*: one spawned process that executes one call at a time. A soft cancel makes the stage's next
`monitor` call raise `Cancelled`; after `GRACE_S` the process is killed and a new one takes its
place. What runs in the process is `workbench.live.lane_process`. Results travel through the store,
never through the pipe; only previews (`workbench.live.preview_call`), which are not kept, are sent
back as they are.
"""

from __future__ import annotations

import itertools
import multiprocessing
import threading
import time
from typing import Any

from workbench.core.base.errors import Cancelled, LaneError, WorkbenchError
from workbench.core.base.monitor import Monitor
from workbench.live.lane_process import serve
from workbench.live.preview_call import PreviewCall
from workbench.pipeline.stage import Call, Outcome
from workbench.pipeline.store import Store
from workbench.planning.stage_table import STAGES

GRACE_S = 2.0
"""Time a stage has to notice a cancel before its process is killed [s]."""
PREVIEW_GRACE_S = 20.0
"""The same of a live press: it is stopped at every move, and its first one loads kernels [s]."""
GOODBYE_S = 2.0
"""Time that workers without a job have to end by themselves when the workbench closes [s]."""
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
while the other two are busy. A lane of another name imports what its calls need as they come.
"""

WAITING = {
    "cad": "waiting until another body is shaped or meshed",
    "sim": "waiting until another press or image is done",
    "look": "waiting until another preview is done",
}
"""What is told of a call whose lane works on another one."""


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
            target=serve,
            args=(self.name, WARM_UP.get(self.name, ()), self.store.root, child, self._cancelled),
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
            monitor(0.0, WAITING.get(self.name, "waiting for other work to end"))
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
