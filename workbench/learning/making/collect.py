"""Make a data set: build once, then solve its cases in spawned processes.

Without a GPU each process solves case after case. With one, presses are settled many side by side
by a process for each GPU, and the others make them ready and read them (`line`).

Done is what has a file, so making it again goes on where it was. A case that fails is written to
`failed.jsonl` with its reason, counted, and left; the others go on. Each process is held to one
thread, as cases are independent and more processes gain more than more threads.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
from collections.abc import Iterable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from pathlib import Path
from typing import Any, TypedDict, Unpack

from workbench.cluster.opening import Cluster
from workbench.core.base.errors import LaneError, MeshingError
from workbench.core.press.press import ContactSettings
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import MembraneMesh
from workbench.learning.dataset.begin import begin, check_place, write_manifest
from workbench.learning.dataset.card import card_text
from workbench.learning.dataset.cases import Case, cases_of
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.lock import held
from workbench.learning.dataset.recipe import Recipe, Solvers
from workbench.learning.dataset.repair import clear_parts
from workbench.learning.dataset.sample_sheet import write_sheet
from workbench.learning.dataset.sequences import write_sequences
from workbench.learning.dataset.sights import LIGHT, Sight, sights_of, write_backgrounds
from workbench.learning.making.cluster_workers import cluster_pools
from workbench.learning.making.line import LOOK_S, Line
from workbench.learning.making.presser import open_presser
from workbench.learning.making.watch import Tell, Watch
from workbench.learning.making.worker import open_bench, solve_case
from workbench.learning.making.worker_messages import Report, Setup
from workbench.pipeline.devices import VARIABLE, chosen_device, cuda_count
from workbench.pipeline.stage import Call
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
AHEAD = 2
"""Cases handed to the pool for each process."""
PER_GPU = 2
"""Pressers for each GPU: one made 84 samples a second on an H100, of which 16 processors could have
read 126; much of its time it launches, and the GPU waits."""
ON_GPU = 128
"""Cases side by side on a GPU: some thousand cells each do not fill it alone."""


class How(TypedDict, total=False):
    """How a data set is made: the options of `make`."""

    jobs: int
    batch: int
    tell: Tell
    monitor: StageMonitor | None
    cluster: Cluster | None


def make(
    recipe: Recipe,
    folder: Path,
    project: Project,
    **how: Unpack[How],
) -> DataSet:
    """Make a data set, or the rest of it.

    Args:
        recipe: What is made.
        folder: Where; a data set of the same recipe in it is gone on with.
        project: Its store has, or gets, mesh, material points and light.
        how: `jobs`, processes; `batch`, presses side by side, 0 for what suits the device;
            `tell`, told how far it is; `monitor`, progress of the stages before the first case;
            `cluster`, whose workers make the samples instead of `jobs` processes.

    Raises:
        StoreError: If the folder is another's, in use, or cannot be written.
        DesignError: If the recipe does not suit the design.
        MeshingError: If finite elements are wanted and the membrane has no hexahedra.
        LaneError: If a process ended by itself; what is done stays.
    """
    jobs, batch = how.get("jobs", 1), how.get("batch", 0)
    tell, monitor = how.get("tell", lambda progress: None), how.get("monitor")
    with held(folder):
        # What is wrong with the folder is said before anything is built.
        check_place(folder, recipe.key)
        sights = sights_of(recipe)
        calls = prepare(recipe, project, sights, monitor)
        mesh = project.store.load("mesh", calls["mesh"].key)
        _check_hexes(recipe, mesh)
        data = begin(folder, recipe.table, mesh.outer, cases_of(recipe, mesh.outer))
        clear_parts(folder)
        setup = Setup(
            recipe=recipe,
            key=data.key,
            folder=folder,
            store=project.store.root,
            calls=calls,
            sights=tuple(sights),
        )
        write_backgrounds(folder, recipe, sights, project.store)
        try:
            cluster = how.get("cluster")
            if cluster is None:
                _collect(data, setup, jobs=jobs, batch=batch or side_by_side(), tell=tell)
            else:
                _collect_on(cluster, data, setup, batch=batch or ON_GPU, tell=tell)
        finally:
            finish(data)
    return data


def prepare(
    recipe: Recipe, project: Project, sights: Sequence[Sight], monitor: StageMonitor | None
) -> dict[str, Call]:
    """Run the stages that all cases share, and the light of all sights.

    Returns:
        The calls of mesh and material points by name.
    """
    settings = ContactSettings(grid_mm=recipe.grid_mm)
    calls = plan(recipe.meshed_design, PressCase(settings=settings))
    wanted = ["mesh"] if recipe.solvers is Solvers.FEM else ["mesh", "lattice"]
    runner = InlineRunner(project.store)
    for chain, names in [(calls, wanted), *((sight.calls, LIGHT) for sight in sights)]:
        for name in needed(chain, [name for name in names if name in chain]):
            runner.run(chain[name], stage_monitor(monitor, name))
    return {name: calls[name] for name in wanted}


def side_by_side() -> int:
    """Cases that a process presses side by side on the device it will open."""
    return ON_GPU if chosen_device() == "cuda" else 1


def _check_hexes(recipe: Recipe, mesh: MembraneMesh) -> None:
    if mesh.hexes is None and recipe.solvers is not Solvers.MPM:
        raise MeshingError(
            f"finite elements need hexahedra: {mesh.notice}",
            hint="use --solver mpm for this membrane",
            at="recipe.solvers",
        )


def _collect(data: DataSet, setup: Setup, *, jobs: int, batch: int, tell: Tell) -> None:
    """Solve what is not done and has not failed."""
    todo, watch = _todo(data, tell)
    if not todo:
        return
    jobs = min(jobs, len(todo))
    try:
        if batch > 1 and setup.recipe.solvers is not Solvers.FEM:
            # Asked before workers are told to leave the GPU alone: processes inherit variables.
            device = chosen_device()
            with _workers(setup, jobs, device="cpu") as workers, _pressers(device) as pressers:
                size = min(batch, -(-len(todo) // len(pressers)))
                Line(workers, pressers, size, watch).run(todo)
        else:
            with _workers(setup, jobs) as workers:
                _one_by_one(todo, workers, AHEAD * jobs, watch)
    except BrokenProcessPool as error:
        raise LaneError(
            "a process that made samples ended by itself",
            hint="finished samples are kept: make it again. If it repeats, the machine may be "
            "out of memory: use fewer --jobs or a smaller --batch",
            at="dataset",
        ) from error


def _todo(data: DataSet, tell: Tell) -> tuple[list[Case], Watch]:
    """Cases that are not done and have not failed, and who counts."""
    failed = data.failed()
    cases = [case for case in data.cases() if case.id not in failed]
    done = {case.id: len(data.frames(case)) for case in cases}
    watch = Watch(data, cases, done, len(failed), tell)
    watch.look(())
    return [case for case in cases if done[case.id] < case.frames], watch


def _collect_on(cluster: Cluster, data: DataSet, setup: Setup, *, batch: int, tell: Tell) -> None:
    """The same by the workers of a cluster."""
    todo, watch = _todo(data, tell)
    if not todo:
        return
    with cluster_pools(cluster, setup) as pools:
        if pools.pressers and setup.recipe.solvers is not Solvers.FEM:
            size = min(batch, -(-len(todo) // len(pools.pressers)))
            Line(pools.workers, pools.pressers, size, watch).run(todo)
        else:
            _one_by_one(todo, pools.workers, AHEAD * pools.width, watch)


def _one_by_one(todo: Iterable[Case], workers: Executor, most: int, watch: Watch) -> None:
    """Let each worker press and solve one case after the other, at most so many under way."""
    waiting, running = iter(todo), dict[Future[Report], Case]()
    while True:
        while len(running) < most and (case := next(waiting, None)):
            running[workers.submit(solve_case, case)] = case
        if not running:
            return
        ended, _ = wait(running, timeout=LOOK_S, return_when=FIRST_COMPLETED)
        for future in ended:
            watch.ended(running.pop(future), future.result())
        watch.look(running.values())


@contextlib.contextmanager
def _workers(setup: Setup, jobs: int, *, device: str = "") -> Iterator[Executor]:
    """Processes that have opened their device, of this name if given."""
    context = multiprocessing.get_context("spawn")
    # Without a lock: a worker killed while it holds one would block the others for ever.
    stop = context.RawValue("b", 0)
    wanted = dict.fromkeys(ONE_THREAD, "1") | ({VARIABLE: device} if device else {})
    with environment(wanted):
        pool = ProcessPoolExecutor(
            jobs, mp_context=context, initializer=open_bench, initargs=(setup, stop)
        )
        with _ended(pool, stop):
            yield pool


@contextlib.contextmanager
def _pressers(device: str) -> Iterator[list[Executor]]:
    """Processes for each GPU; one for the processor where there is none.

    Args:
        device: `cuda` or `cpu`.
    """
    context = multiprocessing.get_context("spawn")
    stop = context.RawValue("b", 0)
    count = cuda_count() if device == "cuda" else 0
    with contextlib.ExitStack() as pools:
        found: list[Executor] = []
        for number in range(PER_GPU * count or 1):
            given = (device, number % count if count > 1 else None, stop)
            pool = ProcessPoolExecutor(
                1, mp_context=context, initializer=open_presser, initargs=given
            )
            pools.enter_context(_ended(pool, stop))
            found.append(pool)
        yield found


@contextlib.contextmanager
def _ended(pool: ProcessPoolExecutor, stop: Any) -> Iterator[None]:
    """When this ends the pool's processes have ended."""
    try:
        yield
    finally:
        stop.value = 1
        pool.shutdown(wait=True, cancel_futures=True)


@contextlib.contextmanager
def environment(wanted: Mapping[str, str]) -> Iterator[None]:
    """Variables for processes that are started meanwhile."""
    before = {name: os.environ.get(name) for name in wanted}
    os.environ.update(wanted)
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
    if count := data.manifest["recipe"].get("sequences", 0):
        write_sequences(data, count)
    write_atomically(data.folder / "card.md", card_text(data).encode())
    write_sheet(data)
