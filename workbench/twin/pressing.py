"""Paths pressed ahead by processes of their own, side by side, into the store.

Each process is held to one thread, and to the processor: the GPU is the photographer's. What a
process raises is kept with the path's name; who asks for the path then finds it in the store, or
the reason.
"""

from __future__ import annotations

import multiprocessing
import signal
from collections.abc import Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path

from workbench.core.base.errors import LaneError, WorkbenchError
from workbench.core.base.monitor import Monitor, silent
from workbench.learning.making.collect import ONE_THREAD, environment
from workbench.pipeline.devices import VARIABLE
from workbench.pipeline.store import Store
from workbench.system.processes import follow_parent
from workbench.twin.cases import TwinCase
from workbench.twin.contact import pressed
from workbench.twin.draw import Twin
from workbench.twin.twin_plan import TwinPlan

LOOK_S = 0.5
"""How often somebody is asked whether to go on [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class _Order:
    twin: Twin
    plan: TwinPlan
    case: TwinCase
    store: Path


def press_ahead(
    twin: Twin, plan: TwinPlan, cases: Sequence[TwinCase], store: Store, monitor: Monitor
) -> dict[str, str]:
    """Press paths side by side; returns those that failed, with the reason.

    Raises:
        Cancelled: If the monitor says so; the processes are ended, and what is stored stays.
        LaneError: If a process ended by itself.
    """
    failed: dict[str, str] = {}
    with environment(dict.fromkeys(ONE_THREAD, "1") | {VARIABLE: "cpu"}):
        pool = ProcessPoolExecutor(
            plan.jobs, mp_context=multiprocessing.get_context("spawn"), initializer=_begin
        )
        try:
            running: dict[Future[str], TwinCase] = {}
            for case in cases:
                order = _Order(twin=twin, plan=plan, case=case, store=store.root)
                running[pool.submit(_press, order)] = case
            while running:
                done = len(cases) - len(running)
                monitor(done / len(cases), f"pressed {done} of {len(cases)} paths")
                ended, _ = wait(running, timeout=LOOK_S, return_when=FIRST_COMPLETED)
                for future in ended:
                    case, why = running.pop(future), future.result()
                    if why:
                        failed[case.id] = why
        except BrokenProcessPool as error:
            raise LaneError(
                "a process that pressed a twin ended by itself",
                hint="what is done is kept: make it again; with fewer --jobs if memory is short",
                at="--jobs",
            ) from error
        finally:
            _end(pool)
    return failed


def _begin() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    follow_parent()


def _press(order: _Order) -> str:
    """Press one path into the store; why not, else ""."""
    try:
        pressed(order.twin, order.plan, order.case, Store(order.store), silent)
    except WorkbenchError as error:
        return error.message
    return ""


def _end(pool: ProcessPoolExecutor) -> None:
    """End its processes at once: a press has nothing to lose that the store has not."""
    workers = list((pool._processes or {}).values())
    pool.shutdown(wait=False, cancel_futures=True)
    for worker in workers:
        worker.terminate()
    for worker in workers:
        worker.join()
