"""Plain NumPy twins of the soft kernels, in double precision, point by point."""

from __future__ import annotations

import numpy as np

from sim.contact.engine.reference import ContactHistory, friction_now
from sim.contact.grid.layout import FREE, HELD, SLID, TOUCHED
from sim.contact.grid.stencil import point_weights
from sim.contact.region.domain import stencil_nodes
from sim.contact.soft.body import SoftObject
from sim.contact.soft.meeting import Meeting
from sim.forces.slip import LEAST_MM


def returned_slip(
    place: np.ndarray,
    anchor: np.ndarray,
    deformation: np.ndarray,
    gradient: np.ndarray,
    limit_mm: float,
) -> np.ndarray:
    """Tangential slip in the undeformed object [mm], shortened onto the friction cone, (3,)."""
    normal = gradient / np.linalg.norm(gradient)
    slip = place - anchor
    slip = slip - (slip @ normal) * normal
    length_mm = np.linalg.norm(deformation @ slip)
    return slip * (limit_mm / length_mm) if length_mm > limit_mm else slip


def contact_forces(
    soft: SoftObject,
    meeting: Meeting,
    stiffness_N_mm: np.ndarray,
    history: ContactHistory,
    *,
    friction: float,
    kinetic_friction: float | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Forces [N] on the points, (P, 3), sensor frame, and on the object's nodes, (N, 3).

    The latter in the object's body frame at the start; first anchors are set in `history`.
    """
    push = np.zeros((len(stiffness_N_mm), 3))
    nodal = np.zeros((len(soft.domain.masses), 3))
    for p in range(len(push)):
        if not meeting.met[p]:
            if history.states[p] == TOUCHED:
                history.states[p] = FREE
            continue
        place, distance_mm = meeting.place_mm[p], meeting.distance_mm[p]
        if history.states[p] == FREE:
            history.states[p], history.anchors[p] = TOUCHED, place
        deformation, steep = meeting.deformation[p], meeting.steep[p]
        coefficient = friction_now(history.states[p], friction, kinetic_friction)
        limit_mm = -coefficient * distance_mm * np.linalg.norm(steep)
        slip = returned_slip(place, history.anchors[p], deformation, meeting.gradient[p], limit_mm)
        push[p] = -stiffness_N_mm[p] * (distance_mm * steep + deformation @ slip)
        cells = place[None] / soft.domain.grid_mm
        weights = point_weights(cells - np.floor(cells + 0.5))[0]
        nodes = stencil_nodes(soft.domain.rows[meeting.cell[p]][None])[0]
        nodal[nodes] -= weights[:, None] * push[p]
    return push @ soft.rotation.T, nodal


def commit_history(
    meeting: Meeting,
    history: ContactHistory,
    *,
    friction: float,
    kinetic_friction: float | None = None,
    slid_mm: float = LEAST_MM,
) -> None:
    """Close a frame: anchors follow the points that slid, and their way is added up."""
    for p in range(len(history.states)):
        if not meeting.met[p] or history.states[p] == FREE:
            history.states[p] = FREE
            continue
        place, gradient = meeting.place_mm[p], meeting.gradient[p]
        coefficient = friction_now(history.states[p], friction, kinetic_friction)
        limit_mm = -coefficient * meeting.distance_mm[p] * np.linalg.norm(meeting.steep[p])
        slip = returned_slip(place, history.anchors[p], meeting.deformation[p], gradient, limit_mm)
        normal = gradient / np.linalg.norm(gradient)
        way = place - slip - history.anchors[p]
        way = meeting.deformation[p] @ (way - (way @ normal) * normal)
        length_mm = np.linalg.norm(way)
        history.slips[p] += length_mm
        history.states[p] = SLID if length_mm > slid_mm else HELD
        history.anchors[p] = place - slip
