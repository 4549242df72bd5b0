"""`--cluster`, for commands that compute many things."""

from __future__ import annotations

import argparse
import contextlib
from collections.abc import Iterator
from concurrent.futures import CancelledError
from typing import TYPE_CHECKING

from workbench.cluster.scheduler_lost import scheduler_lost
from workbench.cluster.where import AT, read_where
from workbench.pipeline.store import Store
from workbench.system.terminal import Progress, complain

if TYPE_CHECKING:
    from workbench.cluster.opening import Cluster
    from workbench.cluster.spreading import Spread

HELP = "spread the work by Dask: local[:N], tcp://HOST:8786, or a TOML file (docs/cluster.md)"


def add_cluster_option(sub: argparse.ArgumentParser) -> None:
    """Add it to a command."""
    sub.add_argument("--cluster", metavar="WHERE", help=HELP)


@contextlib.contextmanager
def cluster_of(words: str | None, store: Store, printer: Progress) -> Iterator[Spread | None]:
    """Who computes side by side while this lasts; None where no cluster was asked for.

    Raises as `open_cluster`.
    """
    with open_cluster(words, store, printer) as cluster:
        if cluster is None:
            yield None
            return
        from workbench.cluster.cluster_runner import ClusterRunner
        from workbench.cluster.spreading import Spread

        runner = ClusterRunner(cluster, store)
        yield Spread(runner=runner, width=cluster.width, stop=runner.stop)


@contextlib.contextmanager
def open_cluster(words: str | None, store: Store, printer: Progress) -> Iterator[Cluster | None]:
    """The cluster while it is used; None where none was asked for.

    Raises:
        DesignError: If there is no such cluster.
        LaneError: If no worker comes, or the scheduler is lost while this lasts.
    """
    if words is None:
        yield None
        return
    where = read_where(words)
    from workbench.cluster.opening import opened

    if where.kind == "slurm" and not printer.as_json:
        complain(f"{where.said['jobs']} jobs go to the queue; work begins with the first that runs")
    with opened(where, store) as cluster:
        if not printer.as_json:
            how = "store shared" if cluster.shared else "results are sent"
            here, width = cluster.here, cluster.width
            workers = f"{width} workers" if here == width else f"{here} of {width} workers so far"
            complain(f"{workers}, {how}; Dask's page: {cluster.dashboard}")
        try:
            yield cluster
        except CancelledError as error:
            # Of what Dask had in hand; who asks to stop raises another one.
            raise scheduler_lost(AT) from error
