"""When a reaction counts as at rest: still, humming about an average, or still on its way."""

from __future__ import annotations

import numpy as np
import pytest

from sim.contact.solver.calm import FORCE_CHANGE, HUM, LOOKS, WIDE, Changes

ALL = np.ones(1, bool)
LOAD_N = np.ones(1)


def seen(normal_N: np.ndarray) -> Changes:
    """What is kept of a reaction along Z, look by look."""
    changes = Changes(1)
    for value in normal_N:
        changes.keep(np.array([[0.0, 0.0, value]]), ALL)
    return changes


def test_a_change_is_the_largest_within_the_looks() -> None:
    """1, 1.2, 1.1 N, now 1 N: .1 within one look, .2 within two; never known before so many."""
    changes, now_N = seen(np.array([1.0, 1.2, 1.1])), np.array([[0.0, 0.0, 1.0]])
    assert changes.within(1, now_N)[0] == pytest.approx(0.1)
    assert changes.within(2, now_N)[0] == pytest.approx(0.2)
    assert changes.within(LOOKS, now_N)[0] == np.inf
    changes.begin(0)
    assert changes.within(1, now_N)[0] == np.inf


@pytest.mark.parametrize(
    ("swing", "drift", "hums"),
    [
        (0.5 * HUM, 0.0, True),
        (2.0 * HUM, 0.0, False),
        (0.5 * HUM, 4.0 * FORCE_CHANGE, False),
    ],
    ids=["rounding", "a swing", "a drift"],
)
def test_a_reaction_hums(swing: float, drift: float, hums: bool) -> None:
    """Up and down at each look, or by so much more over all looks as well."""
    looks = np.arange(2 * WIDE)
    normal_N = 1.0 + 0.5 * swing * (-1.0) ** looks + drift * looks / (2 * WIDE)
    changes = seen(normal_N)
    assert changes.within(LOOKS, np.array([[0.0, 0.0, 1.0]]))[0] > FORCE_CHANGE
    assert bool(changes.hums(LOAD_N)[0]) is hums


def test_nothing_hums_before_it_was_seen_long_enough() -> None:
    """One look too few."""
    assert not seen(np.ones(2 * WIDE - 1)).hums(LOAD_N)[0]
    assert seen(np.ones(2 * WIDE)).hums(LOAD_N)[0]
