"""What slid in a frame of a press: read once the frame is closed and its anchors have moved.

An anchor is the place of the object that a point of the skin holds on to. Over a frame it moves by
what the point slid, less the elastic part of friction, which is below mu times the penetration.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np

from sim.contact.engine.relaxation import Relaxation
from sim.contact.grid.layout import HELD
from sim.contact.readout.frame import FrameOutcome
from sim.contact.readout.problem import Problem
from sim.contact.region.quadrature import SurfacePoints
from sim.forces.slip import MOST_OF_IT, object_way_mm, slip_of

LEAST = 1e-12
"""Guards quotients of vanishing areas and slopes."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Grip:
    """What the P points that may meet the object hold on to at the end of a frame."""

    anchor_mm: np.ndarray
    """Places in the object's body frame, undeformed if it is soft [mm], shape (P, 3)."""
    holds: np.ndarray
    """Whether each point touches, shape (P,), bool."""
    slid_mm: np.ndarray
    """Way that each has slid [mm], shape (P,)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Holding:
    """What the points held on to at both ends of a frame."""

    before: Grip
    now: Grip
    driven_mm: float
    """Farthest way of a driven point in the frame [mm]."""


def grip_of(problem: Problem, relaxation: Relaxation, case: int) -> Grip:
    """What the points of a case hold on to, at the end of a closed frame or at rest."""
    meets = ~problem.domain.points.bonded
    anchors, states = relaxation.contact_history(case)
    return Grip(
        anchor_mm=anchors[meets].astype(np.float64),
        holds=states[meets] >= HELD,
        slid_mm=relaxation.slips_mm(case)[meets],
    )


def with_slip(
    outcome: FrameOutcome, problem: Problem, frame: int, holding: Holding
) -> FrameOutcome:
    """A frame with what slid in it.

    Args:
        outcome: All else of the frame.
        problem: The press.
        frame: Which frame it was, from 0.
        holding: What the points held on to in it.
    """
    before, now = holding.before, holding.now
    domain, approach = problem.domain, problem.approach
    points = domain.points.take(~domain.points.bonded)
    _, gradient = problem.collider.distance(now.anchor_mm)
    normal = gradient / np.maximum(np.linalg.norm(gradient, axis=1, keepdims=True), LEAST)
    moved_mm = now.anchor_mm - before.anchor_mm
    moved_mm -= np.einsum("pc,pc->p", moved_mm, normal)[:, None] * normal
    (old_mm, old_turn), (new_mm, new_turn) = approach.pose(frame), approach.pose(frame + 1.0)
    way_mm = object_way_mm(
        new_mm + now.anchor_mm @ new_turn.T,
        old_mm + now.anchor_mm @ old_turn.T,
        max(float(np.linalg.norm(new_mm - old_mm)), holding.driven_mm),
    )
    slip = slip_of(np.linalg.norm(moved_mm, axis=1), way_mm, before.holds & now.holds)
    stayed_mm2, slid_mm2 = (
        points.to_vertices(points.area_mm2 * chosen, domain.outer.count)
        for chosen in (slip.stayed, slip.sliding)
    )
    return dataclasses.replace(
        outcome,
        sliding=slid_mm2 > MOST_OF_IT * np.maximum(stayed_mm2, LEAST),
        sliding_share=slip.share(points.area_mm2),
        slip_mm=_slip(points, now.slid_mm, domain.outer.count),
    )


def _slip(points: SurfacePoints, slid_mm: np.ndarray, count: int) -> np.ndarray:
    """Mean way of the points around each vertex that have slid at all [mm], (count,), float32."""
    share = points.to_vertices((slid_mm > 0.0).astype(float), count)
    return (points.to_vertices(slid_mm, count) / np.maximum(share, LEAST)).astype(np.float32)
