"""Stopping a server: a signal counts from the first moment, whatever the server is at."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator

import pytest

from ui.app import asked_to_stop

NAMES = (signal.SIGINT, signal.SIGTERM)


@pytest.fixture(autouse=True)
def handlers() -> Iterator[None]:
    """Gives the handlers of the tests back."""
    before = {name: signal.getsignal(name) for name in NAMES}
    yield
    for name, handler in before.items():
        signal.signal(name, handler)


@pytest.mark.parametrize("name", NAMES)
def test_a_signal_where_errors_are_ignored_still_stops(name: signal.Signals) -> None:
    """It comes while an object is destroyed, where Python drops every exception."""

    class Destroyed:
        def __del__(self) -> None:
            os.kill(os.getpid(), name)

    stop = asked_to_stop()
    assert not stop.is_set()
    Destroyed()
    assert stop.wait(5.0)
