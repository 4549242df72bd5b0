"""Runs calls on a cluster: a task is a stage with its key, so nothing is computed twice.

Dask finds a worker, and another where one is lost. What a task leaves lies in the store: the shared
one, or that of the one who asked, to which it is sent once.
"""

from __future__ import annotations

import threading
import time
from concurrent.futures import CancelledError
from typing import Any

from workbench.cluster import remote
from workbench.cluster.opening import Cluster
from workbench.cluster.scheduler_lost import scheduler_lost
from workbench.cluster.shipped import packed, unpacked
from workbench.core.base.errors import Cancelled, LaneError, WorkbenchError
from workbench.core.base.monitor import Monitor
from workbench.pipeline.stage import Call, Outcome, Ref
from workbench.pipeline.store import Store

POLL_S = 0.1


class ClusterRunner:
    """A `Runner` whose calls run elsewhere; any number of threads may share it."""

    def __init__(self, cluster: Cluster, store: Store) -> None:
        self.store = store
        self._cluster = cluster
        self._told: dict[str, tuple[float, str]] = {}
        """The last report of each task."""
        self._sent: dict[Ref, Any] = {}
        """Results that the cluster holds for workers that do not see the store."""
        self._guard = threading.Lock()
        self._stopped = threading.Event()
        cluster.client.subscribe_topic(remote.PROGRESS, self._hear)

    def stop(self) -> None:
        """Let everything that runs raise `Cancelled`."""
        self._stopped.set()

    def _hear(self, event: Any) -> None:
        _, told = event
        self._told[told["task"]] = told["fraction"], told["note"]

    def run(self, call: Call, monitor: Monitor) -> Outcome:
        """Compute the call on the cluster unless it is stored.

        Raises:
            Cancelled: If the monitor raised it; the task ends at its next report.
            LaneError: If the workers that tried it were lost one after the other, or the scheduler
                was.
            WorkbenchError: Whatever the stage raises.
        """
        if self.store.has(call.stage, call.key):
            return Outcome(stage=call.stage, key=call.key, cached=True, seconds=0.0)
        name = f"{call.stage}-{call.key}"
        future = self._submitted(call, name)
        try:
            self._wait(future, name, monitor)
        except Cancelled:
            remote.stop(self._cluster.client, name)
            future.cancel()
            raise
        return self._taken(call, future)

    def _submitted(self, call: Call, name: str) -> Any:
        client, store = self._cluster.client, self.store
        # Errors of ours mean the same on every worker; a lost worker is tried anew by Dask itself.
        if self._cluster.shared:
            return client.submit(remote.run_call, str(store.root), call, name, key=name)
        inputs = {(ref.stage, ref.key): self._scattered(ref) for ref in call.reads}
        return client.submit(remote.run_call_alone, call, name, inputs, key=name)

    def _scattered(self, ref: Ref) -> Any:
        """A stored result on the cluster; sent once."""
        with self._guard:
            if ref not in self._sent:
                content = packed(self.store, ref)
                self._sent[ref] = self._cluster.client.scatter(content, hash=True)
            return self._sent[ref]

    def _wait(self, future: Any, name: str, monitor: Monitor) -> None:
        while not future.done():
            if self._stopped.is_set():
                raise Cancelled("cancelled by the user")
            monitor(*self._told.get(name, (0.0, "waiting for a free machine")))
            time.sleep(POLL_S)

    def _taken(self, call: Call, future: Any) -> Outcome:
        from distributed import KilledWorker

        try:
            found = future.result()
        except WorkbenchError:
            raise
        except KilledWorker as error:
            raise LaneError(
                f"{call.stage} was tried by several workers, and each of them was lost",
                hint="they may be out of memory: start fewer on a machine, or use a coarser mesh",
                at=call.stage,
            ) from error
        except CancelledError as error:
            # Nobody else cancels what is waited for.
            raise scheduler_lost(call.stage) from error
        finally:
            self._told.pop(f"{call.stage}-{call.key}", None)
        if self._cluster.shared:
            return found
        outcome, content = found
        unpacked(self.store, call.ref, content)
        return outcome
