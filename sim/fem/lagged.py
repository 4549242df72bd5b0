"""Minimising with friction held: the start of an increment, and the way round if Newton fails.

With pressure and normal of the friction held, the equations are those of a minimum, which a
projected Newton method with an exact line search always approaches (Kane, Marsden, Ortiz and West,
2000, for friction as an incremental potential). A few such steps begin every increment: a pressure
that is still far off would else drag points along by its friction. Where the exact method fails all
the same, held values are renewed again and again, until its residual is small enough to retry.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from sim.fem.balance import Balance, Equations
from sim.fem.elements import ElementState
from sim.fem.newton import Effort, Solution, first_share, newton
from sim.fem.tangent import Tangent

MOST_LAGS = 12
MOST_STEPS = 30
MOST_EXACT = 8
NEAR = 3e-2
"""Exact relative residual from which the exact method is tried again."""
LOOSEST, SHARE = 1e-3, 0.05
"""Held equations are solved to this, or this share of the exact residual if that is smaller."""
HALVINGS = 6
FLAT = 0.1
"""Share of the slope at the start that counts as none."""
MOST_LOOKS = 8
AWAY = 0.1
"""Share of a bracket that a guess keeps from its ends."""


def lagged(
    equations: Equations,
    displacement_mm: np.ndarray,
    tangent: Tangent,
    effort: Effort,
    *,
    tolerance: float,
) -> Solution | None:
    """Solve from a displacement, shape (N, 3); None if an element is inverted from the start."""
    state = equations.balance(displacement_mm, tangent=False)
    before = np.inf
    for number in range(MOST_LAGS):
        if state is None:
            return None
        goal = max(0.1 * tolerance, min(LOOSEST, SHARE * before))
        held = dataclasses.replace(equations, lag=state.lag())
        displacement_mm = minimise(held, displacement_mm, tangent, effort, tolerance=goal)
        state = equations.balance(displacement_mm, tangent=False)
        if state is None:
            return None
        if state.relative < tolerance:
            return Solution(displacement_mm=displacement_mm, balance=state, converged=True)
        if state.relative < NEAR and number >= 1:
            exact = newton(
                equations,
                displacement_mm,
                tangent,
                effort,
                tolerance=tolerance,
                most=MOST_EXACT,
            )
            if exact is not None and exact.converged:
                return exact
        before = state.relative
    return None


def minimise(
    equations: Equations,
    displacement_mm: np.ndarray,
    tangent: Tangent,
    effort: Effort,
    *,
    tolerance: float,
    most: int = MOST_STEPS,
) -> np.ndarray:
    """Displacement (N, 3) of least potential, as near as it comes; the equations hold friction."""
    known: ElementState | None = None
    for _ in range(most):
        state = equations.balance(displacement_mm, known=known)
        if state is None or state.relative < tolerance:
            break
        effort.lagged += 1
        effort.watch()
        step_mm = _descent(equations, displacement_mm, state, tangent, effort)
        found = _search(equations, displacement_mm, step_mm, state)
        if found is None:
            break
        displacement_mm, known = found
    return displacement_mm


def _descent(
    equations: Equations,
    displacement_mm: np.ndarray,
    state: Balance,
    tangent: Tangent,
    effort: Effort,
) -> np.ndarray:
    """A way of the nodes, shape (N, 3), along which the potential falls."""
    negative = tangent.factorise(state, symmetric=True)
    if not negative:
        step_mm = tangent.solve(state.residual_N)
        if negative == 0 or state.residual_N @ equations.body.system.reduced(step_mm) > 0.0:
            return step_mm
    effort.projected += 1
    convex = equations.balance(displacement_mm, convex=True, known=state.elements)
    assert convex is not None
    positive = _positive(convex.elements.tangent_N_mm)
    tangent.factorise(convex, symmetric=True, elements_N_mm=positive)
    return tangent.solve(state.residual_N)


def _positive(stiffness: np.ndarray | None) -> np.ndarray:
    """Symmetric matrices (M, 24, 24) without their negative eigenvalues."""
    assert stiffness is not None
    values, vectors = np.linalg.eigh(0.5 * (stiffness + np.swapaxes(stiffness, 1, 2)))
    return (vectors * np.maximum(values, 0.0)[:, None, :]) @ np.swapaxes(vectors, 1, 2)


def _search(
    equations: Equations,
    displacement_mm: np.ndarray,
    step_mm: np.ndarray,
    state: Balance,
) -> tuple[np.ndarray, ElementState | None] | None:
    """Where along a step the potential is nearly least, shape (N, 3); None if nowhere lower.

    With it the forces of the elements there, where the search ended with them. The slope along the
    step is minus the residual times it. Stiff contact makes the potential one of kinks, which a
    search that only asks for some decrease follows in twice as many steps.
    """
    way = equations.body.system.reduced(step_mm)
    start = float(state.residual_N @ way)
    if start <= 0.0:
        return None

    last: tuple[float, ElementState] | None = None

    def slope(share: float) -> float | None:
        nonlocal last
        tried = equations.balance(displacement_mm + share * step_mm, tangent=False)
        if tried is None:
            return None
        last = share, tried.elements
        return float(tried.residual_N @ way)

    high = first_share(step_mm)
    at_high = slope(high)
    for _ in range(HALVINGS):
        if at_high is not None:
            break
        high *= 0.5
        at_high = slope(high)
    if at_high is None:
        return None
    share = _root(slope, start, high, at_high)
    known = last[1] if last is not None and last[0] == share else None
    return displacement_mm + share * step_mm, known


def _root(
    slope: Callable[[float], float | None], start: float, high: float, at_high: float
) -> float:
    """Share at which a falling slope, `start` at 0 and `at_high` at `high`, is nearly zero.

    Regula falsi that keeps away from both ends of its bracket.
    """
    low, at_low, share, value = 0.0, start, high, at_high
    for _ in range(MOST_LOOKS):
        if value >= -FLAT * start and (share == high or value <= FLAT * start):
            break
        share = low + (high - low) * at_low / (at_low - at_high)
        margin = AWAY * (high - low)
        share = min(max(share, low + margin), high - margin)
        found = slope(share)
        if found is None:
            break
        value = found
        if value > 0.0:
            low, at_low = share, value
        else:
            high, at_high = share, value
    return share
