"""The way round when Newton's method fails: minimise with friction held, then let friction follow.

With pressure and normal of the friction held, the equations are those of a minimum, which a
projected Newton method with Armijo's rule always approaches (Kane, Marsden, Ortiz and West, 2000,
for friction as an incremental potential). Held values are then renewed, and as soon as the exact
residual is small the exact method takes over.
"""

from __future__ import annotations

import numpy as np

from sim.fem.balance import Balance, Load, balance, tangent_matrix
from sim.fem.body import Body
from sim.fem.contact_law import Lag
from sim.fem.newton import Effort, Solution, Solvers, first_share, newton

MOST_LAGS = 12
MOST_STEPS = 30
MOST_EXACT = 8
NEAR = 3e-2
"""Exact relative residual from which the exact method is tried again."""
LOOSEST, SHARE = 1e-3, 0.05
"""Held equations are solved to this, or this share of the exact residual if that is smaller."""
ARMIJO = 1e-4
HALVINGS = 12
ROUNDING = 1e-11
"""Relative change of the energy below which it says nothing and the residual decides."""


def lagged(
    body: Body,
    load: Load,
    displacement_mm: np.ndarray,
    solvers: Solvers,
    effort: Effort,
    *,
    tolerance: float,
) -> Solution | None:
    """Solve from a displacement, shape (N, 3); None if an element is inverted from the start."""
    state = balance(body, load, displacement_mm, tangent=False)
    before = np.inf
    for number in range(MOST_LAGS):
        if state is None:
            return None
        goal = max(0.1 * tolerance, min(LOOSEST, SHARE * before))
        displacement_mm = minimise(
            body, load, displacement_mm, state.lag(), solvers, effort, tolerance=goal
        )
        state = balance(body, load, displacement_mm, tangent=False)
        if state is None:
            return None
        if state.relative < tolerance:
            return Solution(displacement_mm=displacement_mm, balance=state, converged=True)
        if state.relative < NEAR and number >= 1:
            exact = newton(
                body,
                load,
                displacement_mm,
                solvers,
                effort,
                tolerance=tolerance,
                most=MOST_EXACT,
            )
            if exact is not None and exact.converged:
                return exact
        before = state.relative
    return None


def minimise(
    body: Body,
    load: Load,
    displacement_mm: np.ndarray,
    lag: Lag,
    solvers: Solvers,
    effort: Effort,
    *,
    tolerance: float,
) -> np.ndarray:
    """Displacement (N, 3) of least potential with friction held, as near as it comes."""
    for _ in range(MOST_STEPS):
        state = balance(body, load, displacement_mm, lag=lag)
        if state is None or state.relative < tolerance:
            break
        effort.lagged += 1
        effort.watch()
        step = _descent(body, load, displacement_mm, state, lag, solvers, effort)
        step_mm = body.system.expanded(step)
        moved_mm = _search(body, load, displacement_mm, step_mm, state, lag)
        if moved_mm is None:
            break
        displacement_mm = moved_mm
    return displacement_mm


def _descent(
    body: Body,
    load: Load,
    displacement_mm: np.ndarray,
    state: Balance,
    lag: Lag,
    solvers: Solvers,
    effort: Effort,
) -> np.ndarray:
    """A direction of the free displacements, (E,), in which the potential falls."""
    solver = solvers.symmetric
    negative = solver.factorise(tangent_matrix(body, state))
    if not negative:
        step = solver.solve(state.residual_N)
        if negative == 0 or state.residual_N @ step > 0.0:
            return step
    effort.projected += 1
    convex = balance(body, load, displacement_mm, lag=lag, convex=True)
    assert convex is not None
    positive = _positive(convex.elements.tangent_N_mm)
    solver.factorise(tangent_matrix(body, convex, positive))
    return solver.solve(state.residual_N)


def _positive(stiffness: np.ndarray | None) -> np.ndarray:
    """Symmetric matrices (M, 24, 24) without their negative eigenvalues."""
    assert stiffness is not None
    values, vectors = np.linalg.eigh(0.5 * (stiffness + np.swapaxes(stiffness, 1, 2)))
    return (vectors * np.maximum(values, 0.0)[:, None, :]) @ np.swapaxes(vectors, 1, 2)


def _search(
    body: Body,
    load: Load,
    displacement_mm: np.ndarray,
    step_mm: np.ndarray,
    state: Balance,
    lag: Lag,
) -> np.ndarray | None:
    """Where the potential has fallen enough, shape (N, 3); None if nowhere."""
    slope_Nmm = float(state.residual_N @ body.system.reduced(step_mm))
    size_N = float(np.linalg.norm(state.residual_N))
    share = first_share(step_mm)
    for _ in range(HALVINGS):
        moved_mm = displacement_mm + share * step_mm
        tried = balance(body, load, moved_mm, tangent=False, lag=lag)
        if tried is not None:
            fallen_Nmm = state.energy_Nmm - tried.energy_Nmm
            if fallen_Nmm >= ARMIJO * share * slope_Nmm:
                return moved_mm
            blind = abs(fallen_Nmm) < ROUNDING * max(abs(state.energy_Nmm), 1e-6)
            if blind and np.linalg.norm(tried.residual_N) < size_N:
                return moved_mm
        share *= 0.5
    return None
