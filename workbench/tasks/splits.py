"""Who is learned from, who chooses the epoch, who is tested: at random, or by place.

Shares are the paper's, 3:1:1. Split at random, as the paper does, the depths of one press come to
lie on both sides, and the test asks for what was nearly shown. Split by place, all that touches the
skin at a place is on one side.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from workbench.core.base.errors import DesignError

SHARES = (3, 1, 1)
"""Of training, validation and test. Source: SimTac, *Sim2Real task setup*."""
FEWEST_PLACES = 5


class Parts(NamedTuple):
    """Numbers of the examples of each part."""

    train: np.ndarray
    validation: np.ndarray
    test: np.ndarray


def at_random(count: int, seed: int) -> Parts:
    """Examples one by one.

    Raises:
        DesignError: If a part would be empty.
    """
    return _parts(np.arange(count), seed, "examples")


def by_place(places: np.ndarray, seed: int) -> Parts:
    """All examples of a place, shape (N,), on one side.

    Raises:
        DesignError: If there are too few places.
    """
    _, owner = np.unique(places, return_inverse=True)
    return _parts(owner, seed, "places")


def _parts(owner: np.ndarray, seed: int, what: str) -> Parts:
    groups = int(owner.max(initial=-1)) + 1
    if groups < FEWEST_PLACES:
        raise DesignError(
            f"{groups} {what} cannot be split {':'.join(map(str, SHARES))}",
            hint=f"give {FEWEST_PLACES} or more",
            at="split",
        )
    order = np.random.default_rng(seed).permutation(groups)
    ends = np.round(np.cumsum(SHARES)[:-1] / sum(SHARES) * groups).astype(int)
    return Parts(*(np.flatnonzero(np.isin(owner, each)) for each in np.split(order, ends)))
