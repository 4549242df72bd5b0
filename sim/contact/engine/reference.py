"""Plain NumPy twins of the Taichi kernels, in double precision.

Written for reading, not for speed: weight tables instead of sum factorisation, `np.add.at` instead
of slots, triangle by triangle. Tests compare each with its kernel.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.grid.layout import FREE, HELD, LIFTED, SLID, TOUCHED
from sim.contact.grid.stencil import gradient_table, point_weights
from sim.contact.objects.collider import Collider
from sim.contact.region.domain import Domain, stencil_nodes
from sim.forces.slip import LEAST_MM
from sim.material import stress_of

Pose = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, slots=True)
class PosedObject:
    """The object at a pose."""

    collider: Collider
    pose: Pose
    friction: float
    """Static coefficient of Coulomb's friction against it."""
    kinetic_friction: float | None = None
    """That of points that slide; None: the static one."""

    def friction_of(self, state: int) -> float:
        """Coefficient of a point in a state."""
        return friction_now(state, self.friction, self.kinetic_friction)


@dataclass(kw_only=True, slots=True)
class ContactHistory:
    """Friction memory of the surface points; changed in place."""

    anchors: np.ndarray
    """Anchors in the body frame [mm], shape (P, 3)."""
    states: np.ndarray
    """FREE, TOUCHED, HELD or SLID, shape (P,)."""
    slips: np.ndarray
    """Way slid in settled frames [mm], shape (P,)."""

    @staticmethod
    def fresh(count: int) -> ContactHistory:
        """No contact yet."""
        return ContactHistory(
            anchors=np.zeros((count, 3)), states=np.zeros(count, int), slips=np.zeros(count)
        )


def stress_forces(domain: Domain, displacement: np.ndarray) -> np.ndarray:
    """Elastic forces on the nodes [N], shape (N, 3): -sum of volume P grad(weight)."""
    slopes = gradient_table() / domain.edges_mm[:, None, None, None]
    nodes = stencil_nodes(domain.rows)
    gradient = np.einsum("anr,apnc->aprc", displacement[nodes], slopes)
    shear, bulk = domain.moduli_MPa[:, None, 0], domain.moduli_MPa[:, None, 1]
    stress = stress_of(gradient, shear, bulk, linear=domain.linear)
    forces = np.zeros_like(displacement)
    cell_forces = -np.einsum("ap,aprc,apnc->anr", domain.volumes_mm3, stress, slopes)
    np.add.at(forces, nodes, cell_forces)
    return forces


def point_places(domain: Domain, displacement: np.ndarray) -> np.ndarray:
    """Deformed surface points [mm], sensor frame, shape (P, 3)."""
    return domain.points.position_mm + _point_displacement(domain, displacement)


def _point_nodes(domain: Domain) -> np.ndarray:
    owner = np.repeat(domain.owners, np.diff(domain.owner_starts))
    return stencil_nodes(domain.rows[owner])


def _point_displacement(domain: Domain, displacement: np.ndarray) -> np.ndarray:
    return np.einsum(
        "pn,pnc->pc", point_weights(domain.point_local), displacement[_point_nodes(domain)]
    )


def surface_forces(
    domain: Domain,
    displacement: np.ndarray,
    history: ContactHistory,
    met: PosedObject,
    *,
    goals_mm: np.ndarray | float = 0.0,
) -> np.ndarray:
    """Forces on the membrane at the surface points [N], shape (P, 3); sets first anchors.

    Held points belong at `goals_mm`, shape (P, 3).
    """
    moved = _point_displacement(domain, displacement)
    axis, sideways = domain.points.axis, domain.points.sideways[:, None]
    away = moved - goals_mm
    along = np.einsum("pc,pc->p", axis, away)[:, None] * axis
    spring = along + sideways * (away - along)
    forces = -domain.points.stiffness_N_mm[:, None] * spring
    origin, rotation = met.pose
    place = (domain.points.position_mm + moved - origin) @ rotation
    distance, gradient = met.collider.distance(place)
    for p in np.flatnonzero(~domain.points.bonded):
        forces[p] = 0.0
        if distance[p] >= 0.0:
            if history.states[p] == TOUCHED or distance[p] > LIFTED * domain.grid_mm:
                history.states[p] = FREE
            continue
        if history.states[p] == FREE:
            history.states[p], history.anchors[p] = TOUCHED, place[p]
        friction = met.friction_of(history.states[p])
        slip = returned_slip(place[p], history.anchors[p], distance[p], gradient[p], friction)
        body_force = -domain.points.stiffness_N_mm[p] * (distance[p] * gradient[p] + slip)
        forces[p] = rotation @ body_force
    return forces


def friction_now(state: int, friction: float, kinetic_friction: float | None) -> float:
    """Coefficient of a point: kinetic where it slid in the last settled state, else static."""
    return friction if kinetic_friction is None or state != SLID else kinetic_friction


def returned_slip(
    place: np.ndarray, anchor: np.ndarray, distance: float, gradient: np.ndarray, friction: float
) -> np.ndarray:
    """Tangential slip from the anchor [mm], shortened onto the Coulomb cone, shape (3,)."""
    steepness = np.linalg.norm(gradient)
    normal = gradient / steepness
    slip = place - anchor
    slip = slip - (slip @ normal) * normal
    limit, length = -friction * distance * steepness, np.linalg.norm(slip)
    return slip * (limit / length) if length > limit else slip


def commit_history(
    domain: Domain,
    displacement: np.ndarray,
    history: ContactHistory,
    met: PosedObject,
    *,
    slid_mm: float = LEAST_MM,
) -> None:
    """Close a frame: anchors follow the points that slid, and their way is added up.

    Those that went farther than `slid_mm` are held by kinetic friction from here on.
    """
    origin, rotation = met.pose
    place = (point_places(domain, displacement) - origin) @ rotation
    distance, gradient = met.collider.distance(place)
    for p in np.flatnonzero(~domain.points.bonded):
        if distance[p] < 0.0 and history.states[p] != FREE:
            anchor = history.anchors[p]
            friction = met.friction_of(history.states[p])
            slip = returned_slip(place[p], anchor, distance[p], gradient[p], friction)
            way = place[p] - slip - anchor
            normal = gradient[p] / np.linalg.norm(gradient[p])
            length = np.linalg.norm(way - (way @ normal) * normal)
            history.slips[p] += length
            history.states[p] = SLID if length > slid_mm else HELD
            history.anchors[p] = place[p] - slip
        else:
            history.states[p] = FREE


def spread_to_nodes(domain: Domain, forces: np.ndarray) -> np.ndarray:
    """Nodal forces of forces at the surface points, shape (N, 3)."""
    nodal = np.zeros((len(domain.masses), 3))
    np.add.at(
        nodal, _point_nodes(domain), point_weights(domain.point_local)[:, :, None] * forces[:, None]
    )
    return nodal


def damped_step(
    domain: Domain,
    velocity: np.ndarray,
    forces: np.ndarray,
    *,
    damping: float,
    mass_scale: float,
    largest_step: float,
) -> np.ndarray:
    """Velocity after one substep, which is also the displacement added, shape (N, 3).

    Tied nodes have none of their own: they go where `Ties.lead` says.
    """
    mass = domain.masses[:, None] * mass_scale
    speed = ((2.0 - damping) * velocity + 2.0 * forces / mass) / (2.0 + damping)
    speed = np.clip(speed, -largest_step, largest_step)
    held = domain.fixed.copy()
    held[domain.ties.nodes] = True
    return np.where(held[:, None], velocity, speed)


def squared_distances(corners: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Squared distance of each place (Q, 3) to the nearest of triangles (T, 3, 3), shape (Q,)."""
    best = np.full(len(places), np.inf)
    for a, b, c in corners:
        normal = np.cross(b - a, c - a)
        height = (places - a) @ normal / (normal @ normal)
        foot = places - height[:, None] * normal
        inside = np.ones(len(places), bool)
        for begin, end in ((a, b), (b, c), (c, a)):
            edge = end - begin
            inside &= np.cross(edge, foot - begin) @ normal >= 0.0
            along = np.clip((places - begin) @ edge / (edge @ edge), 0.0, 1.0)
            away = places - begin - along[:, None] * edge
            best = np.minimum(best, (away**2).sum(axis=1))
        plane = ((places - foot) ** 2).sum(axis=1)
        best = np.where(inside, np.minimum(best, plane), best)
    return best


def winding_along_z(corners: np.ndarray, places: np.ndarray) -> np.ndarray:
    """Winding number of each place (Q, 3): entries minus exits of the ray below it, shape (Q,)."""
    winding = np.zeros(len(places), int)
    for a, b, c in corners:
        area = (b[0] - a[0]) * (c[1] - a[1]) - (c[0] - a[0]) * (b[1] - a[1])
        if abs(area) < 1e-14:
            continue
        x, y = places[:, 0] - a[0], places[:, 1] - a[1]
        u = (x * (c[1] - a[1]) - y * (c[0] - a[0])) / area
        v = (y * (b[0] - a[0]) - x * (b[1] - a[1])) / area
        height = a[2] + u * (b[2] - a[2]) + v * (c[2] - a[2])
        crossed = (u >= 0) & (v >= 0) & (u + v < 1) & (height <= places[:, 2])
        winding += np.where(crossed, 1 if area < 0 else -1, 0)
    return winding
