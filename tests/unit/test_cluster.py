"""Clusters: what may be typed, results as bytes, threads that wait, and real workers."""

from __future__ import annotations

import dataclasses
import os
import signal
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workbench.cluster.shipped import packed, unpacked
from workbench.cluster.spreading import Spread, spread
from workbench.cluster.where import Where, read_where
from workbench.core.base.errors import Cancelled, DesignError, StoreError
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.core.result.results import Picture
from workbench.pipeline.stage import Call, Outcome, Ref
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner, plan

SLURM = 'kind = "slurm"\njobs = 2\ncores = 4\nmemory = "8GB"\nqueue = "short"\n'
BAD_FILES = {
    'kind = "slrum"': "slurm",
    "jobs = 2": "ssh",
    'kind = "ssh"': "needs it",
    SLURM.replace("jobs = 2", 'jobs = "two"'): "--cluster",
    f"{SLURM}quue = 1": "queue",
    "kind = ": "local",
}


def test_where_work_is_spread_is_read_as_typed(tmp_path: Path) -> None:
    """Here, at an address, or as a file says."""
    assert read_where("local:3") == Where(kind="local", workers=3)
    assert read_where("local").workers == os.cpu_count()
    assert read_where("tcp://lab:8786") == Where(kind="address", address="tcp://lab:8786")
    path = tmp_path / "lab.toml"
    path.write_text(SLURM)
    assert read_where(str(path)).said == {"jobs": 2, "cores": 4, "memory": "8GB", "queue": "short"}


@pytest.mark.parametrize("words", ["", "locale", "local:0", "local:x", "lab:8786", "none.toml"])
def test_what_is_no_cluster_is_refused_with_what_is(words: str) -> None:
    """With exit status 2 and the ways there are."""
    with pytest.raises(DesignError) as caught:
        read_where(words)
    assert caught.value.at == "--cluster" and "local" in caught.value.hint


@pytest.mark.parametrize("text", BAD_FILES, ids=range(len(BAD_FILES)))
def test_a_file_that_says_no_cluster_is_refused(tmp_path: Path, text: str) -> None:
    """A kind or a word that is not known has the nearest named; what is missing is said."""
    path = tmp_path / "lab.toml"
    path.write_text(text)
    with pytest.raises(DesignError) as caught:
        read_where(str(path))
    told = f"{caught.value.message} {caught.value.hint} {caught.value.at}"
    assert BAD_FILES[text] in told and "lab.toml" in caught.value.message


def test_a_result_travels_as_bytes(tmp_path: Path) -> None:
    """From one store to another, once; what is no result is refused and leaves nothing."""
    here, there = Store(tmp_path / "here"), Store(tmp_path / "there")
    picture, ref = Picture(png=np.arange(9, dtype=np.uint8)), Ref(stage="picture", key="k")
    here.save(ref.stage, ref.key, picture, seconds=1.0, version=1)
    content = packed(here, ref)
    for _ in range(2):
        unpacked(there, ref, content)
    assert np.array_equal(there.load(ref.stage, ref.key).png, picture.png)
    with pytest.raises(StoreError, match="cannot be sent"):
        packed(there, Ref(stage="picture", key="other"))
    (tmp_path / "here" / "picture" / "k" / "meta.json").unlink()
    with pytest.raises(StoreError, match="no result"):
        unpacked(there, Ref(stage="picture", key="l"), packed(here, ref))
    assert [path.name for path in (tmp_path / "there" / "picture").iterdir()] == ["k"]


class Nobody:
    """A runner that is never asked."""

    def run(self, call: Call, monitor: Any) -> Outcome:
        raise AssertionError


def test_so_many_are_under_way_at_once_and_an_error_stops_the_others() -> None:
    """Two wait for each other, which one at a time never could; of ten the last never begin."""
    both = threading.Barrier(2, timeout=5.0)
    done = dict(spread(lambda thing: both.wait() >= 0, [1, 2], Spread(runner=Nobody(), width=2)))
    assert done == {1: True, 2: True}
    stopped, begun = threading.Event(), list[int]()

    def work(thing: int) -> int:
        begun.append(thing)
        if thing == 1:
            raise StoreError("full", hint="", at="")
        if not stopped.wait(5.0):
            raise AssertionError("nobody was told to stop")
        raise Cancelled("stopped")

    with pytest.raises(StoreError, match="full"):
        list(spread(work, range(10), Spread(runner=Nobody(), width=2, stop=stopped.set)))
    assert begun == [0, 1]


Opened = Callable[..., Any]


@pytest.fixture
def opened_cluster() -> Iterator[Opened]:
    """Opens clusters of two workers here, and ends them."""
    pytest.importorskip("distributed")
    import contextlib

    from workbench.cluster.opening import opened

    with contextlib.ExitStack() as things:
        yield lambda store: things.enter_context(opened(Where(kind="local", workers=2), store))


def call_of(stage: str, length_mm: float = 20.0) -> Call:
    design = SensorDesign(name="x", family="finger").replace("shape.cylinder_mm", length_mm)
    return plan(design, PressCase())[stage]


@pytest.mark.slow
@pytest.mark.parametrize("shared", [True, False])
def test_workers_leave_what_this_process_would_have(
    tmp_path: Path, opened_cluster: Opened, shared: bool
) -> None:
    """A body and its mesh, by a shared store or sent: the same key, the same arrays; of two who ask
    for one call at once, one task is made."""
    from workbench.cluster.cluster_runner import ClusterRunner

    here, there = Store(tmp_path / "here"), Store(tmp_path / "there")
    cluster = opened_cluster(there)
    assert cluster.shared and cluster.width == 2
    runner = ClusterRunner(dataclasses.replace(cluster, shared=shared), there)
    both = Spread(runner=runner, width=2)
    chain = [call_of("build"), call_of("mesh")]
    for call in chain:
        InlineRunner(here).run(call, silent)
        asked = [made for _, made in spread(lambda _, c=call: runner.run(c, silent), "ab", both)]
        assert {outcome.key for outcome in asked} == {call.key}
    stages = [task for task in cluster.client.run_on_scheduler(_tasks) if "mesh" in task]
    assert len(set(stages)) == 1
    mine, its = (store.load("mesh", chain[1].key) for store in (here, there))
    assert np.array_equal(mine.outer.points_mm, its.outer.points_mm)
    assert np.array_equal(mine.hexes.cells, its.hexes.cells)
    assert runner.run(chain[1], silent).cached


def _tasks(dask_scheduler: Any) -> list[str]:
    """Names of all that ever ran."""
    return [str(key) for key, *_ in dask_scheduler.transition_log]


def killer(cluster: Any) -> tuple[Callable[..., None], list[int]]:
    """A monitor that kills the first worker that is busy, and its process once it has."""
    killed: list[int] = []

    def kill(fraction: float, note: str = "") -> None:
        busy = cluster.client.processing()
        for worker in [] if killed else [name for name, tasks in busy.items() if tasks]:
            killed.extend(cluster.client.run(os.getpid, workers=[worker]).values())
            os.kill(killed[0], signal.SIGKILL)

    return kill, killed


@pytest.mark.slow
def test_a_killed_worker_loses_nothing_and_a_cancel_ends_the_task(
    tmp_path: Path, opened_cluster: Opened
) -> None:
    """Kill -9 while it meshes: another worker does it; a monitor that raises is obeyed."""
    from workbench.cluster.cluster_runner import ClusterRunner

    store = Store(tmp_path)
    cluster = opened_cluster(store)
    runner = ClusterRunner(cluster, store)
    runner.run(call_of("build"), silent)
    kill, killed = killer(cluster)
    runner.run(call_of("mesh"), kill)
    assert killed and store.has("mesh", call_of("mesh").key)

    def refuse(fraction: float, note: str = "") -> None:
        raise Cancelled("cancelled by the user")

    with pytest.raises(Cancelled):
        runner.run(call_of("build", 21.0), refuse)
    latest = time.monotonic() + 20.0
    while any(cluster.client.processing().values()) and time.monotonic() < latest:
        time.sleep(0.1)
    assert not any(cluster.client.processing().values())


@pytest.mark.slow
def test_rooms_of_the_validation_are_tasks(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The rows that one process gives, in the order asked, and its status."""
    pytest.importorskip("distributed")
    import json

    from workbench.cli import main

    words = ["validate", "--project", str(tmp_path), "search", "published", "--json"]
    alone = main(words)
    mine = json.loads(capsys.readouterr().out)
    assert main([*words, "--cluster", "local:2"]) == alone
    its = json.loads(capsys.readouterr().out)
    assert [(row["name"], row["case"], row["ok"]) for row in its] == [
        (row["name"], row["case"], row["ok"]) for row in mine
    ]
