"""Processes that judge random sensors one by one.

A crash or a hang of the CAD kernel is then one failure, and not the end.
"""

from __future__ import annotations

import contextlib
import multiprocessing
import os
import queue
import time
from collections.abc import Callable
from typing import Any

from workbench.proof.validation.geometry.trials import Finding, Trial

HANG_S = 60.0
"""Time after which a build counts as hung [s]."""


class Workers:
    """Processes that judge trials one by one, and are replaced when they die or hang.

    Args:
        judge: What they do with a trial; a function of a module.
        count: Processes; as many as there are cores when left out.
        hang_s: Time after which one counts as hung [s].
    """

    def __init__(
        self,
        judge: Callable[[Trial], Finding],
        count: int | None = None,
        *,
        hang_s: float = HANG_S,
    ) -> None:
        self._context = multiprocessing.get_context("spawn")
        self._count = count or os.cpu_count() or 1
        self._judge, self._hang_s = judge, hang_s

    def judge(self, todo: list[Trial]) -> list[Finding]:
        """Findings in the order of the trials."""
        waiting: queue.SimpleQueue[int] = queue.SimpleQueue()
        for number in range(len(todo)):
            waiting.put(number)
        found: dict[int, Finding] = {}
        hands = [
            _Hand(self._context, self._judge, self._hang_s)
            for _ in range(min(self._count, len(todo)))
        ]
        try:
            while len(found) < len(todo):
                for hand in hands:
                    if hand.number is None and not waiting.empty() and hand.is_ready():
                        hand.give(waiting.get(), todo)
                    elif hand.number is not None:
                        number, finding = hand.number, hand.answer(todo)
                        if finding is not None:
                            found[number] = finding
        finally:
            for hand in hands:
                hand.close()
        return [found[number] for number in range(len(todo))]


class _Hand:
    """One process."""

    def __init__(self, context: Any, judge: Callable[[Trial], Finding], hang_s: float) -> None:
        self._context, self._judge, self._hang_s = context, judge, hang_s
        self._start()

    def _start(self) -> None:
        self._pipe, child = self._context.Pipe()
        self._process = self._context.Process(target=_serve, args=(child, self._judge), daemon=True)
        self._process.start()
        child.close()
        self.number: int | None = None
        self._since, self._is_ready = 0.0, False

    def is_ready(self) -> bool:
        """Whether it has loaded what it needs, or died over it: then it has no part in a hang."""
        if not self._is_ready:
            with contextlib.suppress(EOFError, OSError):
                if not self._pipe.poll(0.02):
                    return False
                self._pipe.recv()
            self._is_ready = True
        return True

    def give(self, number: int, todo: list[Trial]) -> None:
        """Hand over a trial."""
        self.number, self._since = number, time.monotonic()
        # One that has died is told by its answer.
        with contextlib.suppress(OSError):
            self._pipe.send(todo[number])

    def answer(self, todo: list[Trial]) -> Finding | None:
        """The finding, if there is one yet; a process that died or hangs makes a fault of it."""
        assert self.number is not None
        trial = todo[self.number]
        try:
            if self._pipe.poll(0.02):
                finding = self._pipe.recv()
                self.number = None
                return finding
        except (EOFError, OSError):
            self._process.join(1.0)
            fault = f"the process ended with {self._process.exitcode}"
        else:
            if time.monotonic() - self._since < self._hang_s:
                return None
            fault = f"no answer within {self._hang_s:g} s"
        self.close()
        self._start()
        return Finding(trial=trial, fault=fault)

    def close(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join(1.0)
        self._pipe.close()


def _serve(pipe: Any, judge: Callable[[Trial], Finding]) -> None:
    """Main loop of a worker process."""
    # Imported before the first trial is timed.
    import build123d  # noqa: F401

    pipe.send("ready")
    while True:
        try:
            trial = pipe.recv()
        except EOFError:
            return
        pipe.send(judge(trial))
