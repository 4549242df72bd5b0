"""What a page sends is done in the order in which it was sent."""

from __future__ import annotations

import threading
from functools import partial
from types import SimpleNamespace
from typing import Any

from ui.page.callbacks import put, run_in_order

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


def test_a_value_that_waits_to_be_taken_is_not_overwritten() -> None:
    """An Undo that shows the design anew while a number typed after it waits for its callback."""
    server: Any = SimpleNamespace(gui=SimpleNamespace(), scene=SimpleNamespace())
    run_in_order(server)
    executor = server.gui._thread_executor
    number: Any = SimpleNamespace(value=13.0, _impl=SimpleNamespace(gui_api=server.gui))
    taken: list[float] = []
    sent, shown = threading.Event(), threading.Event()

    def undo(event: Any) -> None:
        sent.wait(10)
        put(number, 13.0)
        shown.set()

    executor.submit(undo, SimpleNamespace(target=None))
    number.value = 14.0
    edit = executor.submit(
        lambda event: taken.append(event.target.value), SimpleNamespace(target=number)
    )
    sent.set()
    assert shown.wait(10)
    edit.result(timeout=10)
    assert taken == [14.0]
    # Taken, it is the design's to say again: of a refused value for example.
    put(number, 13.0)
    assert number.value == 13.0
