"""The same work for many items by processes of their own, side by side.

Each process is held to one thread, and to the processor: a GPU is that of who asks. The work goes
to each process once, in a file: through a pipe, whose reader must start first, processes would
start one after the other.
"""

from __future__ import annotations

import multiprocessing
import pickle
import signal
import tempfile
from collections.abc import Callable, Sequence
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any, TypeVar

from workbench.core.base.errors import LaneError
from workbench.core.base.monitor import Monitor
from workbench.learning.making.collect import ONE_THREAD, environment
from workbench.pipeline.devices import VARIABLE
from workbench.system.processes import follow_parent

LOOK_S = 0.5
"""How often somebody is asked whether to go on [s]."""
Item = TypeVar("Item")
Found = TypeVar("Found")
_own: list[Callable[[Any], Any]] = []
"""The work of this process."""


def side_by_side(
    work: Callable[[Item], Found], items: Sequence[Item], jobs: int, monitor: Monitor
) -> list[Found]:
    """What the work gives for each item, in their order.

    Args:
        work: Picklable, as are the items and what it gives.
        items: One call each.
        jobs: Processes.
        monitor: Progress and cancellation.

    Raises:
        Cancelled: If the monitor says so; the processes are ended at once.
        LaneError: If a process ended by itself.
        Exception: What the work raised, of the first item that did.
    """
    with (
        tempfile.TemporaryDirectory() as folder,
        environment(dict.fromkeys(ONE_THREAD, "1") | {VARIABLE: "cpu"}),
    ):
        file = Path(folder) / "work.pickle"
        file.write_bytes(pickle.dumps(work))
        pool = ProcessPoolExecutor(
            jobs,
            mp_context=multiprocessing.get_context("spawn"),
            initializer=_begin,
            initargs=(file,),
        )
        try:
            running = [pool.submit(_work, item) for item in items]
            waiting = set(running)
            while waiting:
                done = len(items) - len(waiting)
                monitor(done / len(items), f"{done} of {len(items)}")
                ended, waiting = wait(waiting, timeout=LOOK_S, return_when=FIRST_COMPLETED)
                for future in ended:
                    future.result()
            return [future.result() for future in running]
        except BrokenProcessPool as error:
            raise LaneError(
                "a process that worked beside others ended by itself",
                hint="what is done is kept: ask again; with fewer --jobs if memory is short",
                at="--jobs",
            ) from error
        finally:
            _end(pool)


def _begin(file: Path) -> None:
    import cv2

    # The one library that no variable holds to a thread.
    cv2.setNumThreads(1)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    follow_parent()
    _own[:] = [pickle.loads(file.read_bytes())]


def _work(item: Any) -> Any:
    return _own[0](item)


def _end(pool: ProcessPoolExecutor) -> None:
    """End its processes at once: what they are at is not kept half done."""
    workers = list((pool._processes or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for worker in workers:
        worker.terminate()
    for worker in workers:
        worker.join()
