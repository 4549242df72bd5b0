"""Newton's method on the exact equations of one increment, with a nonmonotone line search.

The tangent is unsymmetric, and exact but for the far field. A step never moves a node by more than
half a millimetre, and is halved until the residual is below the largest of the last three (Grippo,
Lampariello and Lucidi, 1986), or the best of six is taken if it is not three times worse.

Near the solution the far field, taken as it is at rest, makes even fresh tangents converge by a
factor of two or three a step only. There the last factors serve on, corrected by Broyden's update
(1965): a step then costs a tenth.
"""

from __future__ import annotations

import itertools
import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from sim.fem.balance import Balance, Equations
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
CLOSE = 3e-2
"""Relative residual from which factors are kept."""
MOST_UPDATES = 8
LEAST_DIVISOR = 0.1
"""Broyden's update divides by a number near 1; below this the factors are of no use any more."""
WORTH = 0.5
"""Share of the residual that a step with kept factors may leave, else they are renewed."""


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
    begun: float = field(default_factory=time.perf_counter)
    """When it began, by `time.perf_counter` [s]."""

    @property
    def steps(self) -> int:
        """Linear systems that were solved, but for those of kept factors."""
        return self.newton + self.lagged

    @property
    def seconds(self) -> float:
        """Time since it began [s]."""
        return time.perf_counter() - self.begun


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
    equations: Equations,
    displacement_mm: np.ndarray,
    tangent: Tangent,
    effort: Effort,
    *,
    tolerance: float,
    most: int,
) -> Solution | None:
    """Solve from a displacement, shape (N, 3); None if an element is inverted from the start.

    Args:
        equations: Of the increment, with each state's own friction.
        displacement_mm: Start; held nodes are where they belong.
        tangent: The linearised equations of the body.
        effort: Counts the steps.
        tolerance: Relative residual to reach.
        most: Steps at most.
    """
    state = equations.balance(displacement_mm, tangent=False)
    if state is None:
        return None
    history: list[float] = []
    for _ in range(most):
        if state.relative < tolerance:
            break
        history.append(float(np.linalg.norm(state.residual_N)))
        stepped = _step(equations, displacement_mm, state, tangent, max(history[-REMEMBERED:]))
        effort.newton += 1
        effort.watch()
        if stepped is None or _stalls(history):
            break
        way_mm = stepped.displacement_mm - displacement_mm
        displacement_mm, state = stepped.displacement_mm, stepped.balance
        if stepped.whole and tolerance <= state.relative < CLOSE:
            displacement_mm, state = _updated(
                equations, stepped, tangent, effort, way_mm, tolerance
            )
    return Solution(
        displacement_mm=displacement_mm, balance=state, converged=state.relative < tolerance
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class _Stepped:
    """Where a step led."""

    displacement_mm: np.ndarray
    balance: Balance
    whole: bool
    """Whether it was not shortened."""


def _step(
    equations: Equations,
    displacement_mm: np.ndarray,
    state: Balance,
    tangent: Tangent,
    reference_N: float,
) -> _Stepped | None:
    """One step with its line search; None if none of the tried ones will do."""
    linear = equations.balance(displacement_mm, known=state.elements)
    assert linear is not None
    tangent.factorise(linear)
    step_mm = tangent.solve(state.residual_N)
    share = first_share(step_mm)
    best: tuple[float, _Stepped] | None = None
    for _ in range(HALVINGS):
        moved_mm = displacement_mm + share * step_mm
        tried = equations.balance(moved_mm, tangent=False)
        if tried is not None:
            size_N = float(np.linalg.norm(tried.residual_N))
            found = _Stepped(displacement_mm=moved_mm, balance=tried, whole=share == 1.0)
            if best is None or size_N < best[0]:
                best = size_N, found
            if size_N < (1.0 - LEAST_GAIN * share) * reference_N:
                return found
        share *= 0.5
    if best is None or not best[0] <= WORST * reference_N:
        return None
    return best[1]


def _updated(
    equations: Equations,
    stepped: _Stepped,
    tangent: Tangent,
    effort: Effort,
    way_mm: np.ndarray,
    tolerance: float,
) -> tuple[np.ndarray, Balance]:
    """Go on with the last factors after a whole step `way_mm`, as long as that pays."""
    body = equations.body
    displacement_mm, state = stepped.displacement_mm, stepped.balance
    steps = [body.system.reduced(way_mm)]
    for _ in range(MOST_UPDATES):
        way = broyden_step(body.system.reduced(tangent.solve(state.residual_N)), steps)
        effort.watch()
        if way is None:
            break
        step_mm = body.system.expanded(way)
        if first_share(step_mm) < 1.0:
            break
        moved_mm = displacement_mm + step_mm
        tried = equations.balance(moved_mm, tangent=False)
        if tried is None or not _is_nearer(tried, state):
            break
        worth = tried.relative < WORTH * state.relative
        displacement_mm, state = moved_mm, tried
        if state.relative < tolerance or not worth:
            break
        steps.append(way)
    return displacement_mm, state


def broyden_step(way: np.ndarray, steps: list[np.ndarray]) -> np.ndarray | None:
    """The next step of Broyden's method from what the first factors say.

    With z = -B_0^-1 F at the newest place and the steps s_0 ... s_k that led there, z becomes
    z + s_(j+1) (s_j . z) / |s_j|^2 for j = 0 ... k - 1, and s_(k+1) = z / (1 - s_k . z / |s_k|^2)
    (Kelley 1995, section 7.3).

    Args:
        way: z, shape (E,).
        steps: s_0 ... s_k, each of shape (E,), all of them whole.

    Returns:
        s_(k+1), shape (E,); None where it would be many times z.
    """
    for before, after in itertools.pairwise(steps):
        way = way + after * (before @ way) / (before @ before)
    last = steps[-1]
    divisor = 1.0 - (last @ way) / (last @ last)
    return way / divisor if divisor > LEAST_DIVISOR else None


def _is_nearer(tried: Balance, state: Balance) -> bool:
    """Whether the residual has fallen, by itself and beside the load."""
    size_N, before_N = np.linalg.norm(tried.residual_N), np.linalg.norm(state.residual_N)
    return bool(size_N < before_N and tried.relative < state.relative)


def _stalls(history: list[float]) -> bool:
    """Whether the last five steps did not halve the residual."""
    if len(history) <= STALLED_AFTER:
        return False
    return min(history[-5:]) > STALLED * min(history[:-5])
