"""Workers and pressers of a cluster, as the pools that make samples.

Whoever has the resource `GPU` presses, one process for each (`dask worker ... --resources GPU=1`);
the others compute on the processor. All of them write into the folder of the data set. Work is
given to a kind of process, never to one by its address: a lost one comes back with another. Presses
and their states stay in the folder on their way: by the one who asks they would all go through a
single process.
"""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import secrets
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from workbench.cluster.opening import Cluster, all_see
from workbench.core.base.errors import DesignError
from workbench.learning.making import presser, worker
from workbench.learning.making.parcels import drop, laid_down
from workbench.learning.making.worker_messages import Setup

GPU = "GPU"
"""The resource of those that press."""
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
    found = _workers(cluster.client)
    with_gpu = sum(found.values())
    others = len(found) - with_gpu
    # What is left where this is killed is cleared when the data set is next gone on with.
    stem = setup.folder / f".part-{secrets.token_hex(4)}"
    opener = _Opener(setup=setup, device="cpu" if with_gpu else "")
    pools = Pools(
        workers=_Pool(cluster, opener, stem, gpu=False),
        width=others or with_gpu,
        pressers=[_Pool(cluster, presser.open_here, stem, gpu=True) for _ in range(with_gpu)],
    )
    try:
        yield pools
    finally:
        for pool in (pools.workers, *pools.pressers):
            pool.shutdown()
        drop(setup.folder.glob(f"{stem.name}-*"))


def _workers(client: Any) -> dict[str, bool]:
    """Addresses of the processes there are, and whether they have a GPU."""
    info = client.scheduler_info(n_workers=-1)["workers"]
    return {name: bool(about.get("resources", {}).get(GPU)) for name, about in info.items()}


@dataclass(frozen=True, kw_only=True)
class _Opener:
    """Makes a process a worker of one data set."""

    setup: Setup
    device: str
    """Of those that do not press; a process that does keeps its GPU whatever it is given."""

    def __call__(self) -> None:
        from distributed import get_worker

        presses = get_worker().state.total_resources.get(GPU)
        worker.open_here(self.setup, "" if presses else self.device)


class _Pool(Executor):
    """Processes of a cluster that are opened before they work."""

    def __init__(
        self, cluster: Cluster, opener: Callable[[], None], stem: Path, *, gpu: bool
    ) -> None:
        self._client = cluster.client
        self._inner = cluster.client.get_executor(pure=False)
        self._work = functools.partial(in_turn, opener, stem)
        self._gpu = gpu

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """As of any executor; of a lost worker Dask tries again on another of the pool."""
        return self._inner.submit(self._work, fn, *args, **self._where(), **kwargs)

    def _where(self) -> dict[str, Any]:
        """Who may do it. Others are allowed too: those that are named may all be lost meanwhile."""
        if self._gpu:
            return {"resources": {GPU: 1}}
        free = [name for name, with_gpu in _workers(self._client).items() if not with_gpu]
        return {"workers": free, "allow_other_workers": True} if free else {}

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """End it, forgetting what has not begun; the processes stay."""
        self._inner.shutdown(wait=False)


def in_turn(
    opener: Callable[[], None], stem: Path, fn: Callable[..., Any], *args: Any, **kwargs: Any
) -> Any:
    """Runs in a process of the cluster; parcels that come of it are left in files."""
    with _turn:
        opener()
        found = fn(*args, **kwargs)
    if isinstance(found, bytes):
        return laid_down(found, stem)
    if isinstance(found, presser.Pressed):
        states = [laid_down(each, stem) for each in found.states]
        return dataclasses.replace(found, states=states)
    return found
