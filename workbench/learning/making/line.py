"""Cases on their way: made ready by workers, settled in batches by pressers, read by workers.

Each presser has a GPU and does nothing else; the workers compute on the processor. There are never
more cases under way than two batches for each presser and as many that are being read, which
bounds memory.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Executor, Future, wait

from workbench.learning.dataset.cases import Case
from workbench.learning.making.parcels import Parcel, drop
from workbench.learning.making.presser import Pressed, press_batch
from workbench.learning.making.watch import Watch
from workbench.learning.making.worker import finish_case, prepare_case
from workbench.learning.making.worker_messages import Report, SettledPress

LOOK_S = 1.0
"""Time between two looks at how many samples there are [s]."""
AHEAD = 2
"""Batches that are ready or being read, for each presser."""

Ready = tuple[Case, Parcel]


class Line:
    """Cases under way through workers and pressers."""

    def __init__(
        self, workers: Executor, pressers: Sequence[Executor], batch: int, watch: Watch
    ) -> None:
        self._workers = workers
        self._idle = deque(pressers)
        self._batch = batch
        self._most = AHEAD * batch * len(pressers)
        self._watch = watch
        self._ready: deque[Ready] = deque()
        self._preparing: dict[Future[Parcel | Report], Case] = {}
        self._pressing: dict[Future[Pressed], tuple[Executor, list[Ready]]] = {}
        self._finishing: dict[Future[Report], tuple[Case, list[Parcel]]] = {}

    def run(self, todo: Iterable[Case]) -> None:
        """Make all samples.

        Raises:
            WorkbenchError, BrokenProcessPool: If a process could not go on.
        """
        waiting = iter(todo)
        while True:
            self._prepare(waiting)
            self._press()
            running = [*self._preparing, *self._pressing, *self._finishing]
            if not running:
                return
            wait(running, timeout=LOOK_S, return_when=FIRST_COMPLETED)
            self._take()
            self._watch.look([case for case, _ in self._finishing.values()])

    def _prepare(self, waiting: Iterator[Case]) -> None:
        while (
            len(self._preparing) + len(self._ready) < self._most
            and len(self._finishing) < self._most
            and (case := next(waiting, None)) is not None
        ):
            self._preparing[self._workers.submit(prepare_case, case)] = case

    def _press(self) -> None:
        """Hand full batches to idle pressers, and what is left where no more will come soon."""
        while self._idle and self._ready:
            if len(self._ready) < self._batch and self._preparing:
                return
            count = min(self._batch, len(self._ready))
            batch = [self._ready.popleft() for _ in range(count)]
            presser = self._idle.popleft()
            future = presser.submit(press_batch, [problem for _, problem in batch])
            self._pressing[future] = presser, batch

    def _take(self) -> None:
        """Take what has ended a step on."""
        for prepared in [future for future in self._preparing if future.done()]:
            case, found = self._preparing.pop(prepared), prepared.result()
            if isinstance(found, Report):
                self._watch.ended(case, found)
            else:
                self._ready.append((case, found))
        for settled in [future for future in self._pressing if future.done()]:
            presser, batch = self._pressing.pop(settled)
            self._idle.append(presser)
            self._finish(batch, settled.result())
        for written in [future for future in self._finishing if future.done()]:
            case, read = self._finishing.pop(written)
            self._watch.ended(case, written.result())
            drop(read)

    def _finish(self, batch: list[Ready], pressed: Pressed) -> None:
        frames = sum(case.frames for case, _ in batch)
        for (case, problem), states in zip(batch, pressed.states, strict=True):
            share = case.frames / frames
            settled = SettledPress(
                states=states, seconds=pressed.seconds * share, cpu_s=pressed.cpu_s * share
            )
            reading = self._workers.submit(finish_case, case, problem, settled)
            self._finishing[reading] = case, [problem, states]
