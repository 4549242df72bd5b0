"""Workers and pressers of a cluster, as the pools that make samples.

Whoever has the resource `GPU` presses, one process for each (`dask worker ... --resources GPU=1`);
the others compute on the processor. All of them write into the folder of the data set.
"""

from __future__ import annotations

import contextlib
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from typing import Any

from workbench.cluster.opening import Cluster, all_see
from workbench.core.base.errors import DesignError
from workbench.learning.making import presser, worker
from workbench.learning.making.worker_messages import Setup

_turn = threading.Lock()
"""A worker with several threads makes one sample at a time: it has one bench."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pools:
    """Those of a cluster."""

    workers: Executor
    width: int
    """Cases that the workers make at once."""
    pressers: list[Executor]
    """None where no worker has a GPU: then each settles its own presses."""


@contextlib.contextmanager
def cluster_pools(cluster: Cluster, setup: Setup) -> Iterator[Pools]:
    """Pools that last as long as this; what has not begun then never does.

    Raises:
        DesignError: If the workers do not see the folders of store and data set.
    """
    for folder in (setup.folder, setup.store):
        if not all_see(cluster.client, folder):
            raise DesignError(
                f"not all workers of the cluster see {folder}",
                hint="put project and data set on a disk that they share",
                at="--cluster",
            )
    info = cluster.client.scheduler_info(n_workers=-1)["workers"]
    with_gpu = [name for name, about in info.items() if about.get("resources", {}).get("GPU")]
    others = [name for name in info if name not in with_gpu] or with_gpu
    device = "cpu" if with_gpu and others != with_gpu else ""
    pools = Pools(
        workers=_Pool(cluster, others, _Opener(setup=setup, device=device)),
        width=len(others),
        pressers=[_Pool(cluster, [name], presser.open_here) for name in with_gpu],
    )
    try:
        yield pools
    finally:
        for pool in (pools.workers, *pools.pressers):
            pool.shutdown()


@dataclass(frozen=True, kw_only=True)
class _Opener:
    """Makes a process a worker of one data set."""

    setup: Setup
    device: str

    def __call__(self) -> None:
        worker.open_here(self.setup, self.device)


class _Pool(Executor):
    """Processes of a cluster that are opened before they work."""

    def __init__(self, cluster: Cluster, names: list[str], opener: Callable[[], None]) -> None:
        self._inner = cluster.client.get_executor(workers=names, pure=False)
        self._opener = opener

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """As of any executor; of a lost worker Dask tries again on another of the pool."""
        return self._inner.submit(in_turn, self._opener, fn, *args, **kwargs)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End it, forgetting what has not begun; the processes stay."""
        self._inner.shutdown(wait=False)


def in_turn(opener: Callable[[], None], fn: Callable[..., Any], *args: Any, **kwargs: Any) -> Any:
    """Runs in a process of the cluster."""
    with _turn:
        opener()
        return fn(*args, **kwargs)
