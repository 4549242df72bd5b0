"""Work that would hold all tabs up: done in one thread, handed over when the desk's pump turns.

Whoever asks says what makes the pieces (a generator, run without the desk's lock) and who takes
them (called under it). A newer request of the same job replaces the one before: of that no
further piece is made, and none that waits is handed over. Jobs take turns, piece by piece, so
that a short one need not wait for the end of a long one.
"""

from __future__ import annotations

import threading
import time
from collections import deque
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

SLICE_S = 0.02
"""Time for handing over at each turn of the pump: other tabs wait so long at most [s]."""
MOST_WAITING = 4
"""Pieces that wait to be handed over; no more are made meanwhile, so that tabs are not flooded."""


@dataclass(eq=False, kw_only=True, slots=True)
class _Request:
    """What one job has asked for."""

    job: str
    pieces: Iterator[Any]
    take: Callable[[Any], None]
    done: deque[Any] = field(default_factory=deque)
    """Pieces that wait to be handed over."""
    ended: bool = False


class BackgroundThread:
    """The thread of one desk, and what waits for its lock."""

    def __init__(self, on_error: Callable[[Exception], None]) -> None:
        self.on_error = on_error
        self._requests: dict[str, _Request] = {}
        self._change = threading.Condition()
        threading.Thread(target=self._work_forever, name="background", daemon=True).start()

    def ask(self, job: str, pieces: Iterator[Any], take: Callable[[Any], None]) -> None:
        """Make pieces in place of what this job asked for before, and hand each to `take`."""
        with self._change:
            # At the end of the row: other jobs come first.
            self._requests.pop(job, None)
            self._requests[job] = _Request(job=job, pieces=pieces, take=take)
            self._change.notify()

    def forget(self, *jobs: str) -> None:
        """Nothing that these jobs asked for is wanted any more."""
        with self._change:
            for job in jobs:
                self._requests.pop(job, None)

    def turn(self) -> None:
        """Hand over what is there, for as long as nobody minds; called under the desk's lock."""
        until_s = time.monotonic() + SLICE_S
        while (found := self._finished()) is not None:
            take, piece = found
            take(piece)
            if time.monotonic() >= until_s:
                return

    def _finished(self) -> tuple[Callable[[Any], None], Any] | None:
        with self._change:
            for request in list(self._requests.values()):
                if request.done:
                    self._change.notify()
                    return request.take, request.done.popleft()
                if request.ended:
                    del self._requests[request.job]
        return None

    def _work_forever(self) -> None:
        while True:
            with self._change:
                self._change.wait_for(lambda: self._open() is not None)
                request = self._open()
                assert request is not None
                # The next job has the next turn.
                self._requests[request.job] = self._requests.pop(request.job)
            self._make_one(request)

    def _open(self) -> _Request | None:
        """The request whose turn it is; None while all have ended or enough waits of them."""
        for request in self._requests.values():
            if not request.ended and len(request.done) < MOST_WAITING:
                return request
        return None

    def _make_one(self, request: _Request) -> None:
        try:
            piece = [next(request.pieces)]
        except StopIteration:
            piece = []
        except Exception as error:
            # The thread must outlive a bug, and the designer must hear of it.
            self.on_error(error)
            piece = []
        with self._change:
            request.done.extend(piece)
            request.ended = not piece
