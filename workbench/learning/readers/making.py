"""Make what a reader learns from: presses, the light of built sensors, views of both.

Each part has a share of the time. Finished parts are kept, so that what was stopped goes on.
"""

from __future__ import annotations

import contextlib
import dataclasses
import math
import multiprocessing
import time
from collections.abc import Sequence
from concurrent.futures import Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.core.base.errors import LaneError, SolveError
from workbench.core.base.monitor import Monitor, part
from workbench.core.design.design import SensorDesign
from workbench.learning.dataset.folder import DataSet
from workbench.learning.making.collect import ONE_THREAD, environment, make, prepare
from workbench.learning.making.watch import SetProgress, Tell
from workbench.learning.readers.built import JUDGING, built_sights, plain_design
from workbench.learning.readers.presses import press_recipe
from workbench.learning.readers.showing import BLOCK, Block, Showing, open_worker, show_blocks
from workbench.learning.readers.states import solved_cases
from workbench.pipeline.devices import VARIABLE
from workbench.project.project import Project

PRESSES, JUDGED, VIEWS = "presses", "judged", "views"
LOOK_S = 0.5
"""Time between two looks at how many blocks there are [s]."""
JUDGED_SHARE = 0.15
"""Presses that judge, of those that are learned from."""
LEAST_JUDGED = 6
"""Presses that judge, however little time there is."""
FRAMES = 6
"""States of a press."""
JUDGED_TIME = 0.2
"""Share of the presses' time for those that judge."""
PRESS_TIME, VIEW_TIME = 0.35, 0.15
"""Shares of the time in which presses and views are made; the rest is for learning."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Amount:
    """How much is made at most; less where time is up."""

    cases: int
    """Presses that are learned from."""
    views: int
    looks: int
    """Built sensors that are learned from."""
    press_share: float = 0.55
    """Of the views: the others are dents by geometry."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Task:
    """What a reader is to learn from."""

    design: SensorDesign
    folder: Path
    amount: Amount
    minutes: float
    """Of the whole training."""
    jobs: int
    batch: int
    """Presses side by side; 0: what suits the device."""
    seed: int


def make_views(task: Task, project: Project, *, monitor: Monitor) -> None:
    """Make presses, looks and views, or the rest of them.

    Raises:
        WorkbenchError: From stages, solver and renderer.
        LaneError: If a process ended by itself; what is done stays.
    """
    design = plain_design(task.design)
    recipe = press_recipe(design, judged=False, seed=task.seed)
    share = part(monitor, 0.0, 0.7)
    _press(task, design, project, share)
    _check_judged(task.folder)
    sights = built_sights(recipe, task.amount.looks)
    monitor(0.7, "light of built sensors")
    prepare(
        dataclasses.replace(recipe, cases=1),
        project,
        sights,
        lambda stage, fraction, note: monitor(0.7, f"light of built sensors: {note or stage}"),
    )
    showing = Showing(
        recipe=recipe,
        sights=tuple(sights),
        store=project.store.root,
        presses=task.folder / PRESSES,
        judged=task.folder / JUDGED,
        out=task.folder / VIEWS,
        seed=task.seed,
        press_share=task.amount.press_share,
        until_s=time.time() + 60.0 * VIEW_TIME * task.minutes,
    )
    _show(showing, blocks_of(task.amount), task.jobs, part(monitor, 0.8, 1.0))


def blocks_of(amount: Amount) -> list[Block]:
    """The blocks of views: those that judge first, then those of each look in turn."""
    looks, count = amount.looks, math.ceil(amount.views / BLOCK)
    judging = max(1, math.ceil(JUDGED_SHARE * count / 2))
    found = [
        Block(
            name=f"judged-{half}-{k:04d}.zip",
            number=2 * k + half,
            look=looks + half,
            judged=True,
            half=half,
        )
        for k in range(judging)
        for half in range(JUDGING)
    ]
    found += [
        Block(name=f"learned-{k:04d}.zip", number=k, look=k % looks, judged=False)
        for k in range(count)
    ]
    return found


def _press(task: Task, design: SensorDesign, project: Project, monitor: Monitor) -> None:
    """Solve presses as long as there is time: first some that judge, then the others."""
    judged = max(LEAST_JUDGED, round(JUDGED_SHARE * task.amount.cases))
    minutes = PRESS_TIME * task.minutes
    for what, name, count, share in (
        ("presses that judge", JUDGED, judged, (0.0, JUDGED_TIME)),
        ("presses", PRESSES, task.amount.cases, (JUDGED_TIME, 1.0)),
    ):
        recipe = press_recipe(design, judged=name == JUDGED, seed=task.seed)
        until = time.monotonic() + 60.0 * minutes * (share[1] - share[0])
        tell = _teller(part(monitor, *share), what, until, LEAST_JUDGED * FRAMES)
        with contextlib.suppress(_TimeIsUp):
            make(
                dataclasses.replace(recipe, cases=count),
                task.folder / name,
                project,
                jobs=task.jobs,
                batch=task.batch,
                tell=tell,
            )


class _TimeIsUp(Exception):
    """No press is begun any more; what is done stays."""


def _check_judged(folder: Path) -> None:
    data = DataSet.open(folder / JUDGED)
    if len(solved_cases(data)) < JUDGING:
        reasons = [str(row["message"]) for row in data.failed().values()]
        raise SolveError(
            f"{len(solved_cases(data))} of the presses that judge a reader could be solved: "
            f"{reasons[0] if reasons else 'all were stopped'}",
            hint="press it in the app to see why, or ask for more --presses",
            at="press",
        )


def _teller(monitor: Monitor, what: str, until: float, least: int) -> Tell:
    """Tells how far presses are, and ends them once time is up and at least so many states are."""

    def tell(progress: SetProgress) -> None:
        note = f"{what}: {progress.done} of {progress.total} states"
        monitor(min(progress.done / max(progress.total, 1), 1.0), note)
        if time.monotonic() > until and progress.done >= least:
            raise _TimeIsUp

    return tell


def _show(showing: Showing, blocks: Sequence[Block], jobs: int, monitor: Monitor) -> None:
    """Make blocks in processes, each of which opens few cameras."""
    showing.out.mkdir(parents=True, exist_ok=True)
    todo = [block for block in blocks if not (showing.out / block.name).exists()]
    if not todo:
        return
    context = multiprocessing.get_context("spawn")
    # Without a lock: a worker killed while it holds one would block the others for ever.
    stop = context.RawValue("b", 0)
    shares = _shares(todo, min(jobs, len(todo)))
    with environment(dict.fromkeys(ONE_THREAD, "1") | {VARIABLE: "cpu"}):
        pool = ProcessPoolExecutor(
            len(shares), mp_context=context, initializer=open_worker, initargs=(showing, stop)
        )
        try:
            running = [pool.submit(show_blocks, share) for share in shares]
            _watch(showing, blocks, running, monitor)
        except BrokenProcessPool as error:
            raise LaneError(
                "a process that made views ended by itself",
                hint="finished views are kept: train again. If it repeats, use fewer --jobs",
                at="--jobs",
            ) from error
        finally:
            stop.value = 1
            pool.shutdown(wait=True, cancel_futures=True)


def _watch(
    showing: Showing, blocks: Sequence[Block], running: list[Future[Any]], monitor: Monitor
) -> None:
    while True:
        done, waiting = wait(running, timeout=LOOK_S)
        there = sum((showing.out / block.name).exists() for block in blocks)
        monitor(there / len(blocks), f"{BLOCK * there} views")
        for future in done:
            future.result()
        if not waiting:
            return


def _shares(blocks: Sequence[Block], count: int) -> list[list[Block]]:
    """Blocks for each process: few looks each, and all of its looks in turn.

    What judges goes first, so that it is there when time is up.
    """
    by_look = sorted(blocks, key=lambda block: (block.look, block.number))
    size = math.ceil(len(by_look) / count)
    shares = [by_look[k * size : (k + 1) * size] for k in range(count)]
    return [
        sorted(share, key=lambda block: (not block.judged, block.number))
        for share in shares
        if share
    ]
