"""Contact and friction at random points of an object against central differences of the same law.

A point where the object's curvature jumps within the step of a difference (the border of a rounded
edge, of a sample's cell) has no derivative there and is left out.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.motion.path import turn
from sim.contact.objects.collider import Collider, make_collider
from sim.fem.contact_law import PENALTY, SLIP_MM, Lag, Law, Touch, Traction, traction
from sim.fem.obstacle import RigidPose, curvature, distance
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter

SEED = 3
TRIED = 200_000
DEEPEST_MM = 0.03
"""Deepest penetration tried: five times what presses reach."""
STEP_MM = 1e-7
JUMP_PER_MM = 1e-3
"""Curvatures that differ by more than this across a step have a jump within it [1/mm]."""
GRID_MM = 0.25
POSE = RigidPose(
    origin_mm=np.array([1.0, -2.0, 3.0]), rotation=turn(np.array([0.0, 0.6, 0.8]), 0.7)
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Rubbed:
    """Random points in contact, each with a random slip around the point of sliding."""

    law: Law
    collider: Collider
    places_mm: np.ndarray
    """Shape (Q, 3)."""
    slip_mm: np.ndarray
    """Shape (Q, 3)."""

    def at(
        self, aside_mm: np.ndarray | float, *, lag: Lag | None = None, tangent: bool = False
    ) -> Traction:
        """The law with all points moved by a vector, their slip with them."""
        places_mm = self.places_mm + aside_mm
        away_mm, gradient = distance(self.collider, POSE, places_mm)
        bend = curvature(self.collider, POSE, places_mm) if tangent else None
        slip_mm = self.slip_mm + aside_mm
        touch = Touch(distance_mm=away_mm, gradient=gradient, curvature=bend, slip_mm=slip_mm)
        return traction(self.law, touch, lag=lag)


@dataclass(frozen=True, kw_only=True, slots=True)
class TangentErrors:
    """Worst errors over all points, each over the size of what it is an error of."""

    contact: float
    """Normal traction alone."""
    friction: float
    """Normal traction and friction, pressure and normal moving along."""
    held: float
    """The same with pressure and normal held."""
    energy: float
    """Traction against the gradient of the potential, pressure and normal held."""
    uncurved: float
    """`friction` without the object's curvature: the null."""
    cone: float
    """Largest tangential over normal traction, over mu."""
    sticking: float
    """`cone` of friction that only sticks, with its stiffness at rest: the null."""
    points: int


def rub(indenter: Indenter, *, friction: float = 0.3) -> Rubbed:
    """Points of an object that touch, without those at a jump of its curvature."""
    rng = np.random.default_rng(SEED)
    collider = make_collider(indenter, grid_mm=GRID_MM)
    span_mm = 0.7 * indenter.size_mm
    places_mm = POSE.origin_mm + rng.uniform(-span_mm, span_mm, (TRIED, 3))
    away_mm, _ = distance(collider, POSE, places_mm)
    places_mm = places_mm[(away_mm < 0.0) & (away_mm > -DEEPEST_MM)]
    places_mm = places_mm[_smooth(collider, places_mm)]
    return Rubbed(
        law=Law(penalty_MPa_mm=PENALTY * Elastomer().young_MPa, friction=friction),
        collider=collider,
        places_mm=places_mm,
        slip_mm=rng.normal(0.0, 0.8 * SLIP_MM, places_mm.shape),
    )


def _smooth(collider: Collider, places_mm: np.ndarray) -> np.ndarray:
    """Points across which the curvature does not jump, shape (Q,), bool."""
    found = np.ones(len(places_mm), dtype=bool)
    for step in STEP_MM * np.eye(3):
        jump = curvature(collider, POSE, places_mm + step)
        jump -= curvature(collider, POSE, places_mm - step)
        found &= np.abs(jump).max(axis=(1, 2)) < JUMP_PER_MM
    return found


def tangent_errors(indenter: Indenter) -> TangentErrors:
    """Compare the law's derivatives with differences at random points of an object."""
    rubbed, smooth = rub(indenter), rub(indenter, friction=0.0)
    state = rubbed.at(0.0, tangent=True)
    flat = Touch(
        distance_mm=distance(rubbed.collider, POSE, rubbed.places_mm)[0],
        gradient=distance(rubbed.collider, POSE, rubbed.places_mm)[1],
        curvature=np.zeros((len(rubbed.places_mm), 3, 3)),
        slip_mm=rubbed.slip_mm,
    )
    normal = np.linalg.norm(state.normal_MPa, axis=1)
    tangential = np.linalg.norm(state.friction_MPa, axis=1)
    along = np.einsum("qi,qi->q", state.lag.normal, rubbed.slip_mm)
    aside_mm = np.sqrt(np.square(rubbed.slip_mm).sum(axis=1) - along**2)
    return TangentErrors(
        contact=_tangent_error(smooth, None, smooth.at(0.0, tangent=True)),
        friction=_tangent_error(rubbed, None, state),
        held=_tangent_error(rubbed, state.lag, rubbed.at(0.0, lag=state.lag, tangent=True)),
        energy=_energy_error(rubbed, state.lag),
        uncurved=_tangent_error(rubbed, None, traction(rubbed.law, flat)),
        cone=float((tangential / normal).max()) / rubbed.law.friction,
        sticking=2.0 * float(aside_mm.max()) / rubbed.law.slip_mm,
        points=len(rubbed.places_mm),
    )


def _tangent_error(rubbed: Rubbed, lag: Lag | None, state: Traction) -> float:
    """Largest error of a point's stiffness over the largest entry of that stiffness."""
    assert state.stiffness_MPa_mm is not None
    columns = [
        rubbed.at(-step, lag=lag).total_MPa - rubbed.at(step, lag=lag).total_MPa
        for step in STEP_MM * np.eye(3)
    ]
    measured = np.stack(columns, axis=2) / (2.0 * STEP_MM)
    error = np.abs(measured - state.stiffness_MPa_mm).max(axis=(1, 2))
    return float((error / np.abs(state.stiffness_MPa_mm).max(axis=(1, 2))).max())


def _energy_error(rubbed: Rubbed, lag: Lag) -> float:
    """Largest error of the traction over the largest traction."""
    slopes = [
        rubbed.at(-step, lag=lag).energy_N_mm - rubbed.at(step, lag=lag).energy_N_mm
        for step in STEP_MM * np.eye(3)
    ]
    measured = np.stack(slopes, axis=1) / (2.0 * STEP_MM)
    known = rubbed.at(0.0, lag=lag).total_MPa
    return float(np.abs(measured - known).max() / np.abs(known).max())
