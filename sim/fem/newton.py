"""Newton's method on the exact equations of one increment, with a nonmonotone line search.

The tangent is exact and unsymmetric. A step never moves a node by more than half a millimetre, and
is halved until the residual is below the largest of the last three (Grippo, Lampariello and Lucidi,
1986), or the best of six is taken if it is not three times worse.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim.fem.balance import Balance, Load, balance
from sim.fem.body import Body
from sim.fem.tangent import Tangent

FARTHEST_MM = 0.5
"""Longest way of a node in a step [mm]."""
HALVINGS = 6
REMEMBERED = 3
LEAST_GAIN = 1e-3
WORST = 3.0
"""Growth of the residual that the best of a line search may have."""
STALLED_AFTER = 9
STALLED = 0.5


def _unwatched() -> None:
    """Nobody waits."""


@dataclass(slots=True)
class Effort:
    """What a solution took."""

    newton: int = 0
    """Steps on the exact equations."""
    lagged: int = 0
    """Steps on equations with friction held."""
    projected: int = 0
    """Of those with element stiffnesses made positive."""
    halved: int = 0
    """Increments that were divided."""
    increments: int = 0
    watch: Callable[[], None] = _unwatched
    """Called at every step; raises to stop."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Solution:
    """A displacement and its forces."""

    displacement_mm: np.ndarray
    """Shape (N, 3)."""
    balance: Balance
    converged: bool


def first_share(step_mm: np.ndarray) -> float:
    """Share of a step (N, 3) that moves no node farther than is allowed."""
    farthest = float(np.abs(step_mm).max(initial=0.0))
    return min(1.0, FARTHEST_MM / farthest) if farthest > 0.0 else 1.0


def newton(
    body: Body,
    load: Load,
    displacement_mm: np.ndarray,
    tangent: Tangent,
    effort: Effort,
    *,
    tolerance: float,
    most: int,
) -> Solution | None:
    """Solve from a displacement, shape (N, 3); None if an element is inverted from the start.

    Args:
        body: The body.
        load: The object.
        displacement_mm: Start; held nodes are where they belong.
        tangent: The linearised equations of the body.
        effort: Counts the steps.
        tolerance: Relative residual to reach.
        most: Steps at most.
    """
    state = balance(body, load, displacement_mm, tangent=False)
    if state is None:
        return None
    history: list[float] = []
    for _ in range(most):
        if state.relative < tolerance:
            break
        history.append(float(np.linalg.norm(state.residual_N)))
        stepped = _step(body, load, displacement_mm, state, tangent, max(history[-REMEMBERED:]))
        effort.newton += 1
        effort.watch()
        if stepped is None or _stalls(history):
            break
        displacement_mm, state = stepped
    return Solution(
        displacement_mm=displacement_mm, balance=state, converged=state.relative < tolerance
    )


def _step(
    body: Body,
    load: Load,
    displacement_mm: np.ndarray,
    state: Balance,
    tangent: Tangent,
    reference_N: float,
) -> tuple[np.ndarray, Balance] | None:
    """One step with its line search; None if none of the tried ones will do."""
    linear = balance(body, load, displacement_mm, known=state.elements)
    assert linear is not None
    tangent.factorise(linear)
    step_mm = tangent.solve(state.residual_N)
    share = first_share(step_mm)
    best: tuple[float, np.ndarray, Balance] | None = None
    for _ in range(HALVINGS):
        moved_mm = displacement_mm + share * step_mm
        tried = balance(body, load, moved_mm, tangent=False)
        if tried is not None:
            size_N = float(np.linalg.norm(tried.residual_N))
            if best is None or size_N < best[0]:
                best = size_N, moved_mm, tried
            if size_N < (1.0 - LEAST_GAIN * share) * reference_N:
                return moved_mm, tried
        share *= 0.5
    if best is None or not best[0] <= WORST * reference_N:
        return None
    return best[1], best[2]


def _stalls(history: list[float]) -> bool:
    """Whether the last five steps did not halve the residual."""
    if len(history) <= STALLED_AFTER:
        return False
    return min(history[-5:]) > STALLED * min(history[:-5])
