"""Make a data set: build once, then solve its cases in spawned processes, one case at a time each.

Done is what has a file, so making it again goes on where it was. A case that fails is written to
`failed.jsonl` with its reason, counted, and left; the others go on. Each process is held to one
thread, as cases are independent and more processes gain more than more threads.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
from collections.abc import Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any

from workbench.core.base.errors import LaneError, MeshingError
from workbench.core.press.press import ContactSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.begin import begin, check_place, write_manifest
from workbench.learning.dataset.card import card_text
from workbench.learning.dataset.cases import Case, cases_of
from workbench.learning.dataset.folder import BACKGROUND, BACKGROUND_MARKERS, DataSet
from workbench.learning.dataset.images import Cameras
from workbench.learning.dataset.lock import held
from workbench.learning.dataset.recipe import Recipe, Solvers
from workbench.learning.dataset.repair import clear_parts
from workbench.learning.dataset.sample_sheet import write_sheet
from workbench.learning.dataset.solving import Report, Setup
from workbench.learning.dataset.watch import Tell, Watch
from workbench.learning.dataset.worker import open_bench, solve_case
from workbench.pipeline.seen_optics import seen_optics
from workbench.planning.plan import InlineRunner, StageMonitor, needed, plan, stage_monitor
from workbench.project.project import Project
from workbench.system.whole_files import write_atomically

ONE_THREAD = (
    "OMP_NUM_THREADS",
    "MKL_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "NUMBA_NUM_THREADS",
    "TI_CPU_MAX_NUM_THREADS",
)
"""Variables that hold libraries to one thread; they are read when a process starts."""
LOOK_S = 1.0
"""Time between two looks at how many samples there are [s]."""
AHEAD = 2
"""Cases handed to the pool for each process."""


def make(
    recipe: Recipe,
    folder: Path,
    project: Project,
    *,
    jobs: int = 1,
    tell: Tell = lambda progress: None,
    monitor: StageMonitor | None = None,
) -> DataSet:
    """Make a data set, or the rest of it.

    Args:
        recipe: What is made.
        folder: Where; a data set of the same recipe in it is gone on with.
        project: Its store has, or gets, mesh, material points and light.
        jobs: Processes.
        tell: Told how far it is.
        monitor: Progress of the stages before the first case.

    Raises:
        StoreError: If the folder is another's, in use, or cannot be written.
        DesignError: If the recipe does not suit the design.
        MeshingError: If finite elements are wanted and the membrane has no hexahedra.
        LaneError: If a process ended by itself; what is done stays.
    """
    with held(folder):
        # What is wrong with the folder is said before anything is built.
        check_place(folder, recipe.key)
        calls = prepare(recipe, project, monitor)
        mesh = project.store.load("mesh", calls["mesh"].key)
        _check_hexes(recipe, mesh)
        data = begin(folder, recipe.table, mesh.outer, cases_of(recipe, mesh.outer))
        clear_parts(folder)
        setup = Setup(
            recipe=recipe, key=data.key, folder=folder, store=project.store.root, calls=calls
        )
        _write_backgrounds(setup, project, mesh)
        try:
            _collect(data, setup, jobs, tell)
        finally:
            finish(data)
    return data


def prepare(recipe: Recipe, project: Project, monitor: StageMonitor | None) -> dict[str, Any]:
    """Run the stages that all cases share; returns their calls by name."""
    settings = ContactSettings(grid_mm=recipe.grid_mm)
    calls = plan(recipe.meshed_design, PressCase(settings=settings))
    wanted = ["mesh"]
    if recipe.solvers is not Solvers.FEM:
        wanted.append("lattice")
    if recipe.images:
        wanted += ["bake", *(["table"] if "table" in calls else [])]
    runner = InlineRunner(project.store)
    for name in needed(calls, wanted):
        runner.run(calls[name], stage_monitor(monitor, name))
    return {name: calls[name] for name in wanted}


def _check_hexes(recipe: Recipe, mesh: MembraneMesh) -> None:
    if mesh.hexes is None and recipe.solvers is not Solvers.MPM:
        raise MeshingError(
            f"finite elements need hexahedra: {mesh.notice}",
            hint="use --solver mpm for this membrane",
            at="recipe.solvers",
        )


def _write_backgrounds(setup: Setup, project: Project, mesh: MembraneMesh) -> None:
    """Images of the skin at rest, once."""
    if not setup.recipe.images or (setup.folder / BACKGROUND_MARKERS).exists():
        return
    from workbench.pipeline.devices import open_device

    open_device()
    light, *tables = (
        project.store.load(name, setup.calls[name].key)
        for name in ("bake", "table")
        if name in setup.calls
    )
    optics = seen_optics(setup.recipe.design.optics)
    plain, marked = Cameras(mesh, light, optics, tables[0] if tables else None).at_rest()
    write_atomically(setup.folder / BACKGROUND, plain)
    write_atomically(setup.folder / BACKGROUND_MARKERS, marked)


def _collect(data: DataSet, setup: Setup, jobs: int, tell: Tell) -> None:
    """Solve what is not done and has not failed."""
    failed = data.failed()
    cases = [case for case in data.cases() if case.id not in failed]
    done = {case.id: len(data.frames(case)) for case in cases}
    todo = [case for case in cases if done[case.id] < case.frames]
    watch = Watch(data, cases, done, len(failed), tell)
    watch.look(())
    if not todo:
        return
    with _pool(setup, min(jobs, len(todo))) as pool:
        waiting, running = iter(todo), dict[Future[Report], Case]()
        while True:
            while len(running) < AHEAD * jobs and (case := next(waiting, None)):
                running[pool.submit(solve_case, case)] = case
            if not running:
                return
            ended, _ = wait(running, timeout=LOOK_S, return_when=FIRST_COMPLETED)
            for future in ended:
                watch.ended(running.pop(future), _report_of(future))
            watch.look(running.values())


def _report_of(future: Future[Report]) -> Report:
    try:
        return future.result()
    except BrokenProcessPool as error:
        raise LaneError(
            "a process that made samples ended by itself",
            hint="finished samples are kept: make it again. If it repeats, the machine may be "
            "out of memory: use fewer --jobs",
            at="dataset",
        ) from error


@contextlib.contextmanager
def _pool(setup: Setup, jobs: int) -> Iterator[ProcessPoolExecutor]:
    """Processes that have opened their device; when this ends they have ended."""
    context = multiprocessing.get_context("spawn")
    # Without a lock: a worker killed while it holds one would block the others for ever.
    stop = context.RawValue("b", 0)
    with _one_thread():
        pool = ProcessPoolExecutor(
            jobs, mp_context=context, initializer=open_bench, initargs=(setup, stop)
        )
        try:
            yield pool
        finally:
            stop.value = 1
            pool.shutdown(wait=True, cancel_futures=True)


@contextlib.contextmanager
def _one_thread() -> Iterator[None]:
    """Variables for processes that are started meanwhile."""
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    os.environ.update(dict.fromkeys(ONE_THREAD, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            os.environ.pop(name)
            if value is not None:
                os.environ[name] = value


def finish(data: DataSet) -> None:
    """Bring counts, card and sheet up to date."""
    write_manifest(data.folder, {**data.manifest, "counts": data.counts()})
    data = DataSet.open(data.folder)
    write_atomically(data.folder / "card.md", card_text(data).encode())
    write_sheet(data)
