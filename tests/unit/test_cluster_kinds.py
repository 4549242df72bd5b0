"""Clusters that are started for a command: by SSH to this machine, and by SLURM's own queue.

Skipped where there is no `ssh localhost` without a password, or no queue that has a node.
"""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

from tests.unit.test_cluster import SLURM, call_of
from workbench.cluster.where import read_where
from workbench.core.base.monitor import silent
from workbench.pipeline.store import Store
from workbench.planning.plan import InlineRunner

FILES = {
    "ssh": 'kind = "ssh"\nhosts = ["localhost", "127.0.0.1"]\n',
    "slurm": 'kind = "slurm"\njobs = 2\ncores = 1\nmemory = "2GB"\nwalltime = "00:10:00"\n',
}
WORKERS = 2
"""Of either."""
TRIED = {
    "ssh": ["ssh", "-o", "BatchMode=yes", "-o", "ConnectTimeout=2", "localhost", "true"],
    "slurm": ["sinfo", "--noheader", "--states=idle"],
}
"""What tells whether there is one; the queue says which nodes it has."""
DAEMON = "__import__('multiprocessing').current_process().daemon"
"""Evaluated by the workers, which do not have this file."""


def test_what_is_asked_for_is_counted_before_it_comes(tmp_path: Path) -> None:
    """A queue starts jobs one after the other; work is handed out for all of them."""
    path = tmp_path / "lab.toml"
    path.write_text(SLURM)
    assert read_where(str(path)).expected == 2 * 4
    path.write_text(FILES["ssh"])
    assert read_where(str(path)).expected == WORKERS
    assert read_where("tcp://lab:8786").expected == 0


@pytest.mark.slow
@pytest.mark.parametrize("kind", FILES)
def test_workers_of_other_hosts_compute_as_ours_do(kind: str, tmp_path: Path) -> None:
    """One thread each and no daemons, or stages that start processes fail there; the arrays are
    those of this process but for rounding, as an SSH session may have another BLAS."""
    pytest.importorskip({"ssh": "asyncssh", "slurm": "dask_jobqueue"}[kind])
    if shutil.which(TRIED[kind][0]) is None:
        pytest.skip(f"no {TRIED[kind][0]} here")
    tried = subprocess.run(TRIED[kind], capture_output=True, text=True, check=False)
    if tried.returncode or (kind == "slurm" and not tried.stdout.strip()):
        pytest.skip(f"no {kind} here")
    from workbench.cluster.cluster_runner import ClusterRunner
    from workbench.cluster.opening import ONE_THREAD, opened

    path = tmp_path / "lab.toml"
    path.write_text(FILES[kind])
    here, there = Store(tmp_path / "here"), Store(tmp_path / "there")
    with opened(read_where(str(path)), there) as cluster:
        cluster.client.wait_for_workers(WORKERS, timeout=60)
        assert cluster.shared and cluster.width == cluster.here == WORKERS
        for name, count in ONE_THREAD.items():
            assert set(cluster.client.run(os.getenv, name).values()) == {count}
        assert set(cluster.client.run(eval, DAEMON).values()) == {False}
        runner = ClusterRunner(cluster, there)
        for call in (call_of("build"), call_of("mesh")):
            runner.run(call, silent)
            InlineRunner(here).run(call, silent)
    mine, its = (store.load("mesh", call_of("mesh").key) for store in (here, there))
    assert np.abs(mine.outer.points_mm - its.outer.points_mm).max() < 1e-12
    assert np.array_equal(mine.hexes.cells, its.hexes.cells)
