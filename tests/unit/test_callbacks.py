"""What a page sends is done in the order in which it was sent."""

from __future__ import annotations

import threading
from functools import partial
from types import SimpleNamespace
from typing import Any

from ui.callbacks import run_in_order

CLICKS = 40


def test_callbacks_that_waited_for_the_desk_run_in_the_order_of_the_messages() -> None:
    """Widgets and clicks in the scene come to a desk that is busy; its lock prefers nobody."""
    server: Any = SimpleNamespace(gui=SimpleNamespace(), scene=SimpleNamespace())
    run_in_order(server)
    desk, done = threading.RLock(), []

    def act(number: int) -> None:
        with desk:
            done.append(number)

    with desk:
        executors = (server.gui._thread_executor, server.scene._thread_executor)
        futures = [executors[k % 2].submit(partial(act, k)) for k in range(CLICKS)]
    for future in futures:
        future.result(timeout=10)
    assert done == list(range(CLICKS))


def test_a_callback_that_fails_leaves_the_next_ones_alive() -> None:
    """The thread outlives an error."""
    server: Any = SimpleNamespace(gui=SimpleNamespace(), scene=SimpleNamespace())
    run_in_order(server)
    failed = server.gui._thread_executor.submit(lambda: 1 / 0)
    assert isinstance(failed.exception(timeout=10), ZeroDivisionError)
    assert server.gui._thread_executor.submit(lambda: "alive").result(timeout=10) == "alive"
