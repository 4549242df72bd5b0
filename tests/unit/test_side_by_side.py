"""Work by processes side by side: in order, with its errors, and never left behind."""

from __future__ import annotations

import multiprocessing
import os
from dataclasses import dataclass

import pytest

from workbench.core.base.errors import Cancelled, DesignError, LaneError
from workbench.core.base.monitor import silent
from workbench.learning.making.side_by_side import side_by_side


@dataclass(frozen=True)
class Halved:
    """Halves even numbers; refuses odd ones, and ends its process at 13."""

    by: int = 2

    def __call__(self, number: int) -> tuple[int, int]:
        if number == 13:
            os._exit(3)
        if number % self.by:
            raise DesignError(f"{number} is odd")
        return number // self.by, os.getpid()


def test_what_comes_back_is_in_the_order_of_the_items() -> None:
    """And from other processes than this one."""
    told: list[float] = []
    found = side_by_side(
        Halved(), range(0, 40, 2), 2, lambda fraction, note="": told.append(fraction)
    )
    assert [half for half, _ in found] == list(range(20))
    assert os.getpid() not in {process for _, process in found}
    assert told == sorted(told) and told[0] == 0.0
    assert not multiprocessing.active_children()


def test_an_error_of_the_work_is_raised_here() -> None:
    """With what it says."""
    with pytest.raises(DesignError, match="7 is odd"):
        side_by_side(Halved(), [2, 7], 2, silent)
    assert not multiprocessing.active_children()


def test_a_process_that_ends_by_itself_is_told() -> None:
    """With what to do about it."""
    with pytest.raises(LaneError) as told:
        side_by_side(Halved(), [2, 13], 2, silent)
    assert "--jobs" in told.value.hint


def test_cancelling_ends_the_processes() -> None:
    """Also where nothing has come back yet."""

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        side_by_side(Halved(), [2], 1, stop)
    assert not multiprocessing.active_children()
