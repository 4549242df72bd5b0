"""A cluster while it is used: its client, whether its workers see our store, and its dashboard."""

from __future__ import annotations

import contextlib
import logging
import secrets
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.cluster.remote import sees
from workbench.cluster.where import AT, Where
from workbench.core.base.errors import DesignError, LaneError
from workbench.core.base.packages import naming_packages
from workbench.pipeline.store import Store

ONE_THREAD = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "NUMBA_NUM_THREADS": "1",
    "TI_CPU_MAX_NUM_THREADS": "1",
}
"""Of workers that we start: processes gain more than threads, and share no cores then."""
PRE_SPAWN = "distributed.nanny.pre-spawn-environ"
"""Dask's setting of it, which workers started by SSH inherit."""
WAIT_S = 60.0
"""How long the first worker may take to come [s]."""
JOBS = "jobs"
"""Folder beside the store with what jobs of a queue have written."""
QUEUED_S = 7 * 86400.0
"""The same of a queue, which the whole institute may stand in [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Cluster:
    """One that is open."""

    client: Any
    """A `distributed.Client`."""
    shared: bool
    """Whether its workers read and write the store's folder, so that results need no sending."""
    dashboard: str
    """Link to Dask's own page."""
    expected: int = 0
    """Workers that it will have once all that were asked for have come, as far as is known."""

    @property
    def here(self) -> int:
        """Workers that have come."""
        return sum(self.client.nthreads().values())

    @property
    def width(self) -> int:
        """How many calls it computes at once, at least 1; what comes later is counted in."""
        return max(1, self.expected, self.here)


@contextlib.contextmanager
def opened(where: Where, store: Store) -> Iterator[Cluster]:
    """A cluster, ended with this where it was started for it.

    Raises:
        DesignError: If it cannot be reached or started.
        LaneError: If no worker comes.
    """
    with naming_packages(), contextlib.ExitStack() as open_things:
        client = _client(where, open_things, store.root.parent / JOBS)
        wait_s = QUEUED_S if where.kind == "slurm" else WAIT_S
        try:
            client.wait_for_workers(1, timeout=wait_s)
        except TimeoutError as error:
            raise LaneError(
                f"no worker of the cluster came within {wait_s:g} s",
                hint="start some: dask worker tcp://HOST:8786 --nthreads 1",
                at=AT,
            ) from error
        yield Cluster(
            client=client,
            shared=all_see(client, store.root),
            dashboard=str(client.dashboard_link),
            expected=where.expected,
        )


def _client(where: Where, open_things: contextlib.ExitStack, jobs: Path) -> Any:
    import dask.config
    from distributed import Client, LocalCluster

    spawned = dask.config.get(PRE_SPAWN, {}) | ONE_THREAD
    # Stages may start processes, which those of a daemon must not.
    settings = {"distributed.worker.daemon": False, PRE_SPAWN: spawned}
    open_things.enter_context(dask.config.set(settings))
    try:
        if where.kind == "address":
            return open_things.enter_context(
                Client(where.address, timeout=10, set_as_default=False)
            )
        if where.kind == "local":
            # Halves of results that are being written belong to the store, not to Dask.
            scratch = open_things.enter_context(tempfile.TemporaryDirectory())
            cluster = LocalCluster(
                n_workers=where.workers,
                threads_per_worker=1,
                processes=True,
                dashboard_address="127.0.0.1:0",
                local_directory=scratch,
                env=ONE_THREAD,
            )
        else:
            cluster = _started(where, jobs)
        open_things.enter_context(cluster)
        return open_things.enter_context(Client(cluster, set_as_default=False))
    except (OSError, TimeoutError, ValueError, RuntimeError) as error:
        raise DesignError(
            f"the cluster cannot be opened: {error}",
            hint="is the scheduler running, and can it be reached from here?",
            at=AT,
        ) from error


def _started(where: Where, jobs: Path) -> Any:
    """A cluster of other machines, started by SSH or by a queue, whose jobs write into a folder."""
    said = where.said
    if where.kind == "ssh":
        from distributed import SSHCluster

        # Every line that a worker writes as it starts is told, as if it were news.
        logging.getLogger("distributed.deploy.ssh").setLevel(logging.WARNING)
        options = {"nthreads": 1, "n_workers": said.get("workers", 1)}
        hosts = [str(host) for host in said["hosts"]]
        python = said.get("python")
        return SSHCluster(
            # The first host is the scheduler's.
            [hosts[0], *hosts],
            worker_options=options,
            **({"remote_python": python} if python else {}),
        )
    from dask_jobqueue.slurm import SLURMCluster  # pyright: ignore[reportMissingImports]

    cores = said["cores"]
    named = {name: said[name] for name in ("queue", "walltime", "account") if name in said}
    # A job inherits no settings of Dask's.
    exported = ONE_THREAD | {"DASK_DISTRIBUTED__WORKER__DAEMON": "False"}
    cluster = SLURMCluster(
        cores=cores,
        processes=cores,
        memory=said["memory"],
        log_directory=str(jobs),
        job_script_prologue=[f"export {name}={value}" for name, value in exported.items()],
        **named,
    )
    cluster.scale(jobs=said["jobs"])
    return cluster


def all_see(client: Any, folder: Path) -> bool:
    """Whether all workers see a file that is made in a folder."""
    token = folder / f".cluster-{secrets.token_hex(6)}"
    token.parent.mkdir(parents=True, exist_ok=True)
    token.touch()
    try:
        return all(client.run(sees, str(token)).values())
    finally:
        token.unlink()
