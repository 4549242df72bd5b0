"""Whether a simulation's step is short enough for a force of ours that follows one step later.

On a spring k with damping t k, a mass m that moves by steps h (v first, then x with the new v)
stays where

    k h (h + 2 t) < 4 m.

Source: the eigenvalue -1 of that step, from det(A + 1) = 0. k is taken for 3/2 of force over dent,
Hertz's for a ball; m for what both bodies give way along the force. A hard landing passes the bound
for a few steps and is borne, so twice the bound is refused.
"""

from __future__ import annotations

import numpy as np

from workbench.core.base.errors import SolveError
from workbench.simulators.mujoco_module import MjData, MjModel, mujoco

HERTZ = 1.5
"""Slope of force over dent, over their quotient: F ~ d^(3/2). Johnson, Contact Mechanics, 1985."""

LEEWAY = 2.0
"""Refused is what passes the bound so many times."""


def check_step(
    simulation: tuple[MjModel, MjData],
    bodies: tuple[int, int],
    push: tuple[np.ndarray, np.ndarray],
    *,
    dent_m: float,
    step_s: float,
    damping_s: float,
) -> None:
    """Refuse a step that would throw a body off.

    Args:
        simulation: Model and data.
        bodies: Numbers of the two that are pushed apart.
        push: Force [N] and its place [m], both (3,), in the world.
        dent_m: How deep the skin gives way.
        step_s: h.
        damping_s: t.

    Raises:
        SolveError: With the longest step.
    """
    force, place_m = push
    length = float(np.linalg.norm(force))
    if not length or not dent_m:
        return
    stiffness_N_m = HERTZ * length / dent_m
    gives_1_kg = sum(_gives_1_kg(*simulation, body, place_m, force / length) for body in bodies)
    if stiffness_N_m * gives_1_kg * step_s * (step_s + 2.0 * damping_s) < LEEWAY * 4.0:
        return
    longest_s = (damping_s**2 + 4.0 / (stiffness_N_m * gives_1_kg)) ** 0.5 - damping_s
    raise SolveError(
        f"steps of {1e3 * step_s:.3g} ms are too long for {1e3 / gives_1_kg:.2g} g on a skin of "
        f"{1e-3 * stiffness_N_m:.2g} N/mm: it would be thrown off; the limit is "
        f"{1e3 * longest_s:.2g} ms",
        hint="call the sensor after each step, lower model.opt.timestep or damping_s, or make the "
        "object heavier",
        at="timestep",
    )


def _gives_1_kg(
    model: MjModel, data: MjData, body: int, place_m: np.ndarray, along: np.ndarray
) -> float:
    """Acceleration of a place of a body by a unit force there, along it: J M^-1 J^T."""
    if not model.nv:
        return 0.0
    jacobian, answer = np.zeros((3, model.nv)), np.zeros((1, model.nv))
    mujoco().mj_jac(model, data, jacobian, None, place_m, body)
    row = (along @ jacobian)[None]
    mujoco().mj_solveM(model, data, answer, row)
    return float(row[0] @ answer[0])
