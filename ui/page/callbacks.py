"""Callbacks of shared widgets run one after the other, in the order in which the pages sent them.

viser runs each in one of 32 threads, where a click on *Run press* can overtake the number that was
typed before it: both wait for the desk's lock, which does not know who came first. Windows of a tab
of its own (`client.gui`) are left to viser's threads.

viser (1.1) has no setting for it: the executors of shared widgets and scene are replaced.
"""

from __future__ import annotations

import threading
from collections import Counter
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import Any


class InOrder(ThreadPoolExecutor):
    """One thread for callbacks; knows whose are still to be run."""

    def __init__(self) -> None:
        super().__init__(max_workers=1, thread_name_prefix="callbacks")
        self._waiting: Counter[int] = Counter()
        self._count = threading.Lock()

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Run a callback after those before it; its event, if any, is the first argument."""
        target = id(getattr(args[0], "target", None)) if args else 0

        def run() -> Any:
            with self._count:
                self._waiting[target] -= 1
            return fn(*args, **kwargs)

        with self._count:
            self._waiting[target] += 1
        return super().submit(run)

    def waits(self, widget: Any) -> bool:
        """Whether a page has sent something of this widget that has not been taken yet."""
        with self._count:
            return self._waiting[id(widget)] > 0


def run_in_order(server: Any) -> None:
    """Give the shared widgets and the scene of a server one thread for all their callbacks."""
    one = InOrder()
    server.gui._thread_executor = one
    server.scene._thread_executor = one


def put(widget: Any, value: Any) -> None:
    """Let a widget show a value, unless a page has just given it one that is yet to be taken.

    An Undo that shows the design anew would else overwrite the number typed right after it.
    """
    if widget.value == value:
        return
    executor = widget._impl.gui_api._thread_executor
    if not (isinstance(executor, InOrder) and executor.waits(widget)):
        widget.value = value
