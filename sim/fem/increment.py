"""One increment of a path: predict, solve, remember; or divide it and try the halves.

Nothing is remembered of an increment that did not converge.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim.contact.objects.collider import Collider
from sim.fem.balance import Balance, Equations, Load
from sim.fem.body import Body
from sim.fem.contact_law import Lag, Law
from sim.fem.lagged import lagged, minimise
from sim.fem.newton import Effort, Solution, newton
from sim.fem.obstacle import RigidPose
from sim.fem.tangent import Tangent
from sim.forces.slip import Slip, object_way_mm, slip_of
from workbench.core.base.errors import SolveError

START_TOLERANCE = 0.1
"""Relative residual, with the friction of the last increment, at which exact steps begin."""
MOST_STARTING = 12
MOST_NEWTON = 10
MOST_HALVINGS = 4
LONGEST_GUESS = 2.0
"""The predictor moves no node farther than this multiple of the object's way."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pairing:
    """What does not change along a path."""

    tangent: Tangent
    """The linearised equations of the body."""
    law: Law
    collider: Collider
    pose_at: Callable[[float], RigidPose]
    """The object's pose after a number of frames."""
    held_mm: Callable[[float], np.ndarray]
    """Displacement of held nodes after a number of frames, shape (N, 3), zero elsewhere."""
    tolerance: float

    @property
    def body(self) -> Body:
        """What is pressed."""
        return self.tangent.body


@dataclass(frozen=True, kw_only=True, slots=True)
class State:
    """A body in equilibrium with the object, and what friction remembers."""

    progress: float
    """Frames that are done."""
    displacement_mm: np.ndarray
    """Shape (N, 3)."""
    places_mm: np.ndarray
    """Contact points, shape (P, 3)."""
    elastic_mm: np.ndarray
    """Elastic slip, shape (P, 3)."""
    slid_mm: np.ndarray
    """Way that each point has slid since it last touched, shape (P,)."""
    slides: np.ndarray
    """Whether each slid in the increment that led here, shape (P,), bool."""
    balance: Balance | None = None
    """Forces; None before the first increment."""


def at_rest(pairing: Pairing) -> State:
    """The body before anything moves."""
    zero = np.zeros_like(pairing.body.points_mm)
    places_mm = pairing.body.faces.places(pairing.body.points_mm)
    return State(
        progress=0.0,
        displacement_mm=zero,
        places_mm=places_mm,
        elastic_mm=np.zeros_like(places_mm),
        slid_mm=np.zeros(len(places_mm)),
        slides=np.zeros(len(places_mm), dtype=bool),
    )


def advance(
    pairing: Pairing,
    state: State,
    progress: float,
    effort: Effort,
    *,
    halvings: int = 0,
    watch: Callable[[float], None] = lambda progress: None,
) -> State:
    """The state after `progress` frames, by one increment or, if that fails, by several.

    Args:
        pairing: Body, object and path.
        state: Where it stands.
        progress: Where it goes.
        effort: Counts what it took.
        halvings: How often this piece of the path has been halved.
        watch: Told the progress reached; raises to stop.

    Raises:
        SolveError: If a sixteenth of the increment does not converge either.
    """
    found = increment(pairing, state, progress, effort)
    if found is not None:
        watch(progress)
        return found
    if halvings >= MOST_HALVINGS:
        raise SolveError(
            f"the increment from frame {state.progress:.3f} to {progress:.3f} did not converge, "
            f"divided into {2**MOST_HALVINGS}",
            hint="lower press.depth_mm or the shear, or round the object's edges",
            at="press.depth_mm",
        )
    effort.halved += 1
    middle = 0.5 * (state.progress + progress)
    for goal in (middle, progress):
        state = advance(pairing, state, goal, effort, halvings=halvings + 1, watch=watch)
    return state


def increment(pairing: Pairing, state: State, progress: float, effort: Effort) -> State | None:
    """The state after `progress` frames; None if neither method converges."""
    tangent = pairing.tangent
    old, new = _equations(pairing, state, state.progress), _equations(pairing, state, progress)
    start_mm = _predicted(pairing, state, progress, old, new)
    start_mm = minimise(
        dataclasses.replace(new, lag=_lag(state)),
        start_mm,
        tangent,
        effort,
        tolerance=START_TOLERANCE,
        most=MOST_STARTING,
    )
    found = newton(
        new,
        start_mm,
        tangent,
        effort,
        tolerance=pairing.tolerance,
        most=MOST_NEWTON,
    )
    if found is None or not found.converged:
        found = lagged(new, start_mm, tangent, effort, tolerance=pairing.tolerance)
    if found is None or not found.converged:
        # The last factors are of no state that another increment begins with.
        tangent.forget()
        return None
    effort.increments += 1
    return _remembered(pairing, state, progress, found)


def _equations(pairing: Pairing, state: State, progress: float) -> Equations:
    """Balance of forces after `progress` frames, with the memory of `state` carried there."""
    return Equations(body=pairing.body, load=_load(pairing, state, progress))


def _load(pairing: Pairing, state: State, progress: float) -> Load:
    """The object after `progress` frames, with the memory of `state` carried there."""
    before, pose = pairing.pose_at(state.progress), pairing.pose_at(progress)
    return Load(
        law=pairing.law,
        collider=pairing.collider,
        pose=pose,
        anchor_mm=pose.carried(state.places_mm, before),
        elastic_mm=state.elastic_mm @ pose.turn(before).T,
        slides=state.slides,
    )


def _lag(state: State) -> Lag:
    """Pressure and normal of friction as the last increment left them."""
    if state.balance is not None:
        return state.balance.lag()
    count = len(state.slid_mm)
    return Lag(pressure_MPa=np.zeros(count), normal=np.zeros((count, 3)))


def _predicted(
    pairing: Pairing, state: State, progress: float, old: Equations, new: Equations
) -> np.ndarray:
    """First guess (N, 3): held nodes moved, the others by the tangent about the old state.

    The last factors are those of a state a step from it. With the stiffness of contact that they
    hold they say as well where the object pushes the skin, unless held nodes move.
    """
    body = pairing.body
    held_mm = pairing.held_mm(progress) - pairing.held_mm(state.progress)
    moved_mm = state.displacement_mm + held_mm
    driven = bool(held_mm.any())
    met = None if driven else pairing.tangent.met
    known: Balance | None = None
    if met is None:
        known = old.balance(
            state.displacement_mm,
            known=None if state.balance is None else state.balance.elements,
        )
        assert known is not None and known.face_N_mm is not None
        met = known.touching_faces, known.face_N_mm
    touching_faces, face_N_mm = met
    nodes = body.faces.nodes[touching_faces]
    corners_mm = (body.points_mm + state.displacement_mm)[nodes]
    way_mm = new.load.pose.carried(corners_mm, old.load.pose) - corners_mm
    pushed = face_N_mm @ (way_mm - held_mm[nodes]).reshape(-1, 12, 1)
    right_N = body.system.gather(nodes, pushed[..., 0])
    if driven and known is not None:
        right_N = right_N + _pulled(body, held_mm, known)
    right = body.system.reduced(right_N)
    if not right.any():
        return moved_mm
    if known is not None:
        pairing.tangent.factorise(known)
    step_mm = pairing.tangent.solve(right)
    farthest_mm = LONGEST_GUESS * max(
        float(np.abs(way_mm).max(initial=0.0)), float(np.abs(held_mm).max(initial=0.0))
    )
    step_mm *= min(1.0, farthest_mm / max(float(np.abs(step_mm).max(initial=0.0)), 1e-12))
    guess = new.balance(moved_mm + step_mm, tangent=False)
    return moved_mm if guess is None else moved_mm + step_mm


def _pulled(body: Body, held_mm: np.ndarray, known: Balance) -> np.ndarray:
    """Forces on the nodes, (N, 3), as held ones move by `held_mm`, (N, 3)."""
    assert known.elements.tangent_N_mm is not None
    pulled = known.elements.tangent_N_mm @ held_mm[body.elements.cells].reshape(-1, 24, 1)
    gel_N, _ = body.spring_forces(held_mm)
    return gel_N - body.system.gather(body.elements.cells, pulled[..., 0])


def slid_since(pairing: Pairing, before: State, progress: float, forces: Balance) -> Slip:
    """Which contact points slid from a state to a balance of forces after `progress` frames."""
    pose, old = pairing.pose_at(progress), pairing.pose_at(before.progress)
    carried_mm = pose.carried(before.places_mm, old)
    now = forces.lag()
    moved_mm = forces.places_mm - carried_mm
    moved_mm -= np.einsum("pc,pc->p", moved_mm, now.normal)[:, None] * now.normal
    stayed = now.pressure_MPa > 0.0
    stayed &= before.balance is not None and before.balance.lag().pressure_MPa > 0.0
    driven_mm = pairing.held_mm(progress) - pairing.held_mm(before.progress)
    origin_mm = float(np.linalg.norm(pose.origin_mm - old.origin_mm))
    least_mm = max(origin_mm, float(np.linalg.norm(driven_mm, axis=1).max()))
    way_mm = object_way_mm(carried_mm, before.places_mm, least_mm)
    return slip_of(np.linalg.norm(moved_mm, axis=1), way_mm, stayed)


def _remembered(pairing: Pairing, state: State, progress: float, found: Solution) -> State:
    """The state with the friction's memory of a converged increment."""
    forces = found.balance
    elastic_mm, slid_mm = np.zeros_like(state.elastic_mm), np.zeros_like(state.slid_mm)
    elastic_mm[forces.members] = forces.traction.elastic_mm
    slid_mm[forces.members] = state.slid_mm[forces.members] + forces.traction.slid_mm
    return State(
        progress=progress,
        displacement_mm=found.displacement_mm,
        places_mm=forces.places_mm,
        elastic_mm=elastic_mm,
        slid_mm=slid_mm,
        slides=slid_since(pairing, state, progress, forces).sliding,
        balance=forces,
    )
