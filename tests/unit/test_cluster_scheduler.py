"""A scheduler that is killed in the middle: what runs says so, and a new one goes on."""

from __future__ import annotations

import contextlib
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from concurrent.futures import Future
from pathlib import Path
from types import SimpleNamespace

import pytest

from workbench.cli.cluster_option import open_cluster
from workbench.cluster import opening
from workbench.cluster.cluster_runner import ClusterRunner
from workbench.cluster.where import read_where
from workbench.core.base.errors import LaneError
from workbench.core.base.monitor import silent
from workbench.core.design.design import SensorDesign
from workbench.core.press.press_case import PressCase
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.system.free_port import free_port
from workbench.system.terminal import Progress

ROOT = Path(__file__).parents[2]


@contextlib.contextmanager
def running(
    scratch: Path, *words: str, before: tuple[str, ...] = ()
) -> Iterator[subprocess.Popen[bytes]]:
    """A `dask` process, as a user starts one; `before` stands before its words. Killed with
    this."""
    settings = {"DASK_DISTRIBUTED__WORKER__DAEMON": "False", "PYTHONPATH": str(ROOT)}
    settings |= {"OMP_NUM_THREADS": "1"}
    process = subprocess.Popen(
        [*before, sys.executable, "-m", "dask", *words],
        env={**os.environ, **settings},
        cwd=scratch,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@contextlib.contextmanager
def lab(scratch: Path, port: int) -> Iterator[subprocess.Popen[bytes]]:
    """A scheduler with a worker; yields the scheduler's process."""
    scratch.mkdir()
    address = f"tcp://127.0.0.1:{port}"
    about = ("--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    worker = (address, "--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "20")
    with running(scratch, "scheduler", *about) as scheduler:
        with running(scratch, "worker", *worker):
            yield scheduler


def test_a_command_says_that_the_scheduler_was_lost(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Dask cancels all futures then, of data sets too; their error is nobody's to read."""

    @contextlib.contextmanager
    def opened(*_: object) -> Iterator[SimpleNamespace]:
        yield SimpleNamespace(width=1, shared=True, dashboard="")

    monkeypatch.setattr(opening, "opened", opened)
    future = Future[None]()
    future.cancel()
    with pytest.raises(LaneError, match="scheduler was lost") as caught:
        with open_cluster("local:1", Store(tmp_path), Progress(as_json=True)):
            future.result()
    assert "again" in caught.value.hint and caught.value.at == "--cluster"


@pytest.mark.slow
def test_a_killed_scheduler_is_told_and_the_next_one_goes_on(tmp_path: Path) -> None:
    """Kill -9 while a mesh is asked for: the one who asks hears of it with the remedy; on a new
    scheduler at the same address the body is found and the mesh is made."""
    pytest.importorskip("distributed")
    port, store = free_port(), Store(tmp_path / "store")
    where = read_where(f"tcp://127.0.0.1:{port}")
    calls = plan(SensorDesign(name="x", family="finger"), PressCase())
    with lab(tmp_path / "first", port) as scheduler, opening.opened(where, store) as cluster:
        runner = ClusterRunner(cluster, store)
        assert not runner.run(calls["build"], silent).cached

        def kill(fraction: float, note: str = "") -> None:
            if scheduler.poll() is None:
                os.kill(scheduler.pid, signal.SIGKILL)
                scheduler.wait()

        with pytest.raises(LaneError, match="scheduler was lost") as caught:
            runner.run(calls["mesh"], kill)
        assert scheduler.returncode == -signal.SIGKILL
        assert "again" in caught.value.hint
    with lab(tmp_path / "second", port), opening.opened(where, store) as cluster:
        runner = ClusterRunner(cluster, store)
        assert runner.run(calls["build"], silent).cached
        runner.run(calls["mesh"], silent)
    assert store.has("mesh", calls["mesh"].key)
