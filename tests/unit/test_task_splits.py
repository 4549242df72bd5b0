"""Splits of tasks: nothing of a place is on two sides, and each seed has its own."""

from __future__ import annotations

import numpy as np
import pytest

from workbench.core.base.errors import DesignError
from workbench.tasks.splits import at_random, by_place

PLACES = np.array([f"place{number % 11}" for number in range(132)])


def test_a_split_by_place_keeps_places_whole() -> None:
    """11 places: 7, 2 and 2 of them, none in two parts, all examples in one."""
    parts = by_place(PLACES, 0)
    found = [set(PLACES[rows].tolist()) for rows in parts]
    assert [len(each) for each in found] == [7, 2, 2]
    assert len(set.union(*found)) == 11
    assert sorted(np.concatenate(parts).tolist()) == list(range(132))


def test_a_random_split_takes_3_to_1_to_1_and_leaks_places() -> None:
    """60, 20 and 20 of 100; the places of the test are seen in training, as the paper's."""
    parts = at_random(100, 1)
    assert [len(rows) for rows in parts] == [60, 20, 20]
    whole = at_random(len(PLACES), 1)
    assert set(PLACES[whole.test].tolist()) <= set(PLACES[whole.train].tolist())


def test_seeds_split_differently_and_each_the_same_twice() -> None:
    """What is tested depends on the seed alone."""
    assert by_place(PLACES, 3).test.tolist() == by_place(PLACES, 3).test.tolist()
    assert by_place(PLACES, 3).test.tolist() != by_place(PLACES, 4).test.tolist()


def test_too_few_places_are_refused() -> None:
    """Four places cannot be 3:1:1."""
    with pytest.raises(DesignError, match="4 places cannot be split 3:1:1"):
        by_place(np.array(list("abcdabcd")), 0)
