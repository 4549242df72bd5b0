"""Two hosts with a shared folder, of which one dies: processes with other names of the machine."""

from __future__ import annotations

import contextlib
import shutil
import socket
import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests.unit.test_cluster import call_of, killer
from tests.unit.test_cluster_scheduler import running
from workbench.cluster import opening
from workbench.cluster.cluster_runner import ClusterRunner
from workbench.cluster.where import Where
from workbench.core.base.monitor import silent
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner
from workbench.system.free_port import free_port

pytest.importorskip("distributed")

HOSTS = ("lab1", "lab2")
WORKER = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--death-timeout", "30")


def may_rename() -> bool:
    """Whether a process may be given a host's name of its own."""
    if shutil.which("unshare") is None:
        return False
    tried = subprocess.run(["unshare", "--uts", "true"], capture_output=True, check=False)
    return tried.returncode == 0


@pytest.mark.slow
@pytest.mark.skipif(not may_rename(), reason="no right to a host's name of one's own")
def test_a_host_dies_and_the_other_goes_on(tmp_path: Path) -> None:
    """Killed while it meshes: the arrays are those of one process, nothing half-written counts."""
    here, there = Store(tmp_path / "here"), Store(tmp_path / "there")
    port = free_port()
    address = f"tcp://127.0.0.1:{port}"
    scheduler = ("scheduler", "--host", "127.0.0.1", "--port", str(port), "--no-dashboard")
    with contextlib.ExitStack() as things:
        things.enter_context(running(tmp_path, *scheduler))
        for name in HOSTS:
            renamed = ("unshare", "--uts", "sh", "-c", f'hostname {name}; exec "$@"', "sh")
            words = ("worker", address, *WORKER)
            things.enter_context(running(tmp_path, *words, before=renamed))
        where = Where(kind="address", address=address)
        cluster = things.enter_context(opening.opened(where, there))
        cluster.client.wait_for_workers(len(HOSTS), timeout=60)
        assert set(cluster.client.run(socket.gethostname).values()) == set(HOSTS)
        assert cluster.shared
        runner = ClusterRunner(cluster, there)
        runner.run(call_of("build"), silent)
        kill, killed = killer(cluster)
        runner.run(call_of("mesh"), kill)
    assert killed
    for call in (call_of("build"), call_of("mesh")):
        InlineRunner(here).run(call, silent)
    mine, its = (store.load("mesh", call_of("mesh").key) for store in (here, there))
    assert np.array_equal(mine.outer.points_mm, its.outer.points_mm)
    assert np.array_equal(mine.hexes.cells, its.hexes.cells)
