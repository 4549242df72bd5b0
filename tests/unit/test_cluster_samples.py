"""A data set made by the workers of a cluster, beside the same made here."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import os
import signal
import time
from collections.abc import Iterator
from concurrent.futures import Executor, Future
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tests.synthetic_presses import pad_recipe
from workbench.cli.command_line import parser
from workbench.cli.commands import task
from workbench.cluster.opening import Cluster
from workbench.core.base.errors import Cancelled, DesignError, StoreError
from workbench.learning.dataset.recipe import Solvers
from workbench.learning.making import collect, presser, worker
from workbench.learning.making.cluster_workers import GPU, Pools, _Pool, cluster_pools, in_turn
from workbench.learning.making.collect import make
from workbench.learning.making.parcels import laid_down
from workbench.learning.making.worker_messages import Setup
from workbench.pipeline.store import Store
from workbench.project.project import Project
from workbench.tasks import run


class Blind:
    """A client whose second worker is on a machine without the shared disk."""

    def run(self, function: Any, path: str) -> dict[str, bool]:
        return {"here": function(path), "there": False}


def test_workers_that_do_not_see_the_folder_are_refused(tmp_path: Path) -> None:
    """Before anything is made, with the folder and the remedy; the file that was tried is gone."""
    cluster = Cluster(client=Blind(), shared=False, dashboard="")
    setup = Setup(
        recipe=pad_recipe(), key="k", folder=tmp_path, store=tmp_path, calls={}, sights=()
    )
    with pytest.raises(DesignError, match="not all workers") as caught:
        with cluster_pools(cluster, setup):
            raise AssertionError("there are no pools")
    assert str(tmp_path) in caught.value.message and "disk" in caught.value.hint
    assert not list(tmp_path.iterdir())


def test_presses_of_a_task_are_made_where_the_task_looks_for_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By the workers first: the same recipe in the same folder, so the task finds all of them."""
    given = list[tuple[Any, Path, Any]]()

    def noted(recipe: Any, folder: Path, project: Project, **how: Any) -> None:
        given.append((recipe.key, folder, how.get("cluster")))
        if "cluster" not in how:
            raise Cancelled("far enough")

    @contextlib.contextmanager
    def opened(*_: object) -> Iterator[Cluster]:
        yield Cluster(client=Blind(), shared=True, dashboard="")

    monkeypatch.setattr(collect, "make", noted)
    monkeypatch.setattr(run, "make", noted)
    monkeypatch.setattr(task, "open_cluster", opened)
    typed = ["task", "safety", "pad", "--out", str(tmp_path / "out"), "--cluster", "local:2"]
    options = parser().parse_args([*typed, "--json"])
    with pytest.raises(Cancelled):
        task.run(options, Project(tmp_path / "project"))
    there, here = given
    assert there[:2] == here[:2] and there[1] == tmp_path / "out" / "data"
    assert isinstance(there[2], Cluster) and here[2] is None


def nothing() -> None:
    """Opens nothing."""


@pytest.mark.slow
@pytest.mark.parametrize("gpu", [False, True])
def test_work_goes_on_by_the_process_that_replaces_a_lost_one(gpu: bool, tmp_path: Path) -> None:
    """Of either kind, though the new process has another address and no other is of its kind."""
    distributed = pytest.importorskip("distributed")
    presses = {"cls": distributed.Nanny, "options": {"nthreads": 1, "resources": {GPU: 1}}}
    computes = {"cls": distributed.Nanny, "options": {"nthreads": 1}}
    scheduler = {"cls": distributed.Scheduler, "options": {"dashboard": False}}
    with (
        distributed.SpecCluster(
            workers={"presses": presses, "computes": computes}, scheduler=scheduler
        ) as processes,
        distributed.Client(processes) as client,
    ):
        client.wait_for_workers(2, timeout=60)
        pool = _Pool(
            Cluster(client=client, shared=True, dashboard=""), nothing, tmp_path / "x", gpu=gpu
        )
        first = pool.submit(os.getpid).result(timeout=60)
        waiting = pool.submit(time.sleep, 2.0)
        time.sleep(0.5)
        os.kill(first, signal.SIGKILL)
        waiting.result(timeout=60)
        assert pool.submit(os.getpid).result(timeout=60) != first


def test_a_press_that_cannot_be_laid_down_says_why(tmp_path: Path) -> None:
    """A missing folder stands for a full disk: an error with its remedy, no traceback."""
    with pytest.raises(StoreError, match="cannot write"):
        laid_down(b"press", tmp_path / "gone" / ".part-x")


class AtOnce(Executor):
    """Does what a process of a cluster would, here and at once."""

    def __init__(self, opener: Any, stem: Path) -> None:
        self._work = functools.partial(in_turn, opener, stem)
        self.came: list[Any] = []

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        found = Future[Any]()
        self.came.append(self._work(fn, *args, **kwargs))
        found.set_result(self.came[-1])
        return found


@pytest.mark.slow
def test_presses_on_their_way_through_a_cluster_lie_in_files_that_go(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No process but those of the cluster has them; samples are those of a case at a time."""
    recipe = dataclasses.replace(pad_recipe(cases=2), solvers=Solvers.MPM, grid_mm=1.0)
    project = Project(tmp_path / "project")
    made = list[AtOnce]()

    @contextlib.contextmanager
    def pools(_: object, setup: Setup) -> Iterator[Pools]:
        stem = setup.folder / ".part-x"
        made[:] = AtOnce(lambda: worker.open_here(setup), stem), AtOnce(nothing, stem)
        yield Pools(workers=made[0], width=1, pressers=[made[1]])

    monkeypatch.setattr(collect, "cluster_pools", pools)
    monkeypatch.setattr(presser, "_stop", SimpleNamespace(value=0))
    there = make(recipe, tmp_path / "there", project, cluster=cast(Any, object()))
    here = make(recipe, tmp_path / "here", project)
    assert there.counts() == here.counts() and here.counts()["cases_done"] == 2
    assert sum(isinstance(each, Path) for each in made[0].came) == 2
    assert all(isinstance(each, Path) for each in made[1].came[0].states)
    assert not list((tmp_path / "there").glob(".part-*"))
    for mine, its in zip(here.samples(), there.samples(), strict=True):
        forces = [cast(Any, pair[1]).mpm.reaction_N for pair in (mine, its)]
        assert np.allclose(*forces, rtol=1e-9, atol=0.0) and np.linalg.norm(forces[0]) > 0.0


@pytest.mark.slow
def test_samples_of_a_cluster_are_those_made_here(tmp_path: Path) -> None:
    """Two presses of two frames and more by two workers: every sample has the same forces."""
    pytest.importorskip("distributed")
    from workbench.cluster.opening import opened
    from workbench.cluster.where import Where

    recipe = dataclasses.replace(pad_recipe(cases=2), solvers=Solvers.MPM, grid_mm=1.0)
    project = Project(tmp_path / "project")
    store: Store = project.store
    with opened(Where(kind="local", workers=2), store) as cluster:
        there = make(recipe, tmp_path / "there", project, cluster=cluster)
    here = make(recipe, tmp_path / "here", project)
    assert there.counts() == here.counts() and here.counts()["cases_done"] == 2
    pairs = list(zip(here.samples(repeats=True), there.samples(repeats=True), strict=True))
    assert len(pairs) >= 4
    for mine, its in pairs:
        sample = [cast(Any, pair[1]) for pair in (mine, its)]
        assert mine[0].id == its[0].id
        forces = [each.mpm.reaction_N for each in sample]
        assert np.array_equal(*forces) and np.linalg.norm(forces[0]) > 0.0
