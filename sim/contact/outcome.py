"""From the state of a settled frame to the numbers of `Contact`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import taichi as ti
from taichi.lang.impl import current_cfg

from sim.contact.approach import Approach
from sim.contact.collider import Collider
from sim.contact.domain import Domain
from sim.contact.relaxation import Balance, Relaxation
from workbench.core.frames import quaternion
from workbench.core.results import Skin
from workbench.core.sensing import Contact

SLIDING_SHARE = 0.999
"""Share of the friction cone at which a point counts as sliding."""
LEAST = 1e-12
"""Guards quotients of vanishing forces and slopes."""
LEAST_PRESSURE_SHARE = 1e-3
"""Points that carry less than this share of the largest normal force have no friction ratio."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FrameOutcome:
    """One frame of `Contact`; the fields have the same names and units."""

    displacement_mm: np.ndarray
    inner_mm: np.ndarray
    reaction_N: np.ndarray
    moment_Nmm: np.ndarray
    indenter_pose: np.ndarray
    residual: float
    penetration_mm: float
    support_N: np.ndarray
    cut_N: np.ndarray
    friction_ratio: float
    sliding: np.ndarray


def frame_outcome(
    relaxation: Relaxation,
    outer: Skin,
    approach: Approach,
    balance: Balance,
    frame: int,
    *,
    scale_N: float,
) -> FrameOutcome:
    """Read a settled frame, evaluated at its pose and not yet committed.

    Args:
        relaxation: The state.
        outer: The skin whose displacement and overlap are wanted.
        approach: The path.
        balance: Forces of the state.
        frame: Which frame.
        scale_N: Force that the residual is relative to, the same as for the stop test.
    """
    domain = relaxation.domain
    origin, rotation = approach.pose(frame + 1.0)
    nodal = relaxation.displacement().astype(np.float64)
    displacement = domain.outer.displacement_mm(nodal)
    inner = domain.inner
    open_points = ~domain.points.bonded
    forces = relaxation.point_forces()[open_points].astype(np.float64)
    place = (domain.points.position_mm + point_displacement(domain, nodal))[open_points]
    distance, gradient = relaxation.collider.distance((place - origin) @ rotation)
    normal = gradient @ rotation.T
    friction_ratio, sliding_points = _friction(forces, normal, friction=relaxation.friction)
    sliding = np.zeros(len(outer.points_mm), bool)
    sliding[domain.points.vertex[open_points][sliding_points]] = True
    vertex_mm = outer.points_mm + displacement
    overlap_mm = deepest_overlap_mm(vertex_mm, relaxation.collider, origin, rotation)
    return FrameOutcome(
        displacement_mm=displacement,
        inner_mm=np.zeros((0, 3), np.float32) if inner is None else inner.displacement_mm(nodal),
        reaction_N=balance.reaction_N,
        moment_Nmm=-np.cross(place - origin, forces).sum(axis=0),
        indenter_pose=np.concatenate([origin, quaternion(rotation)]),
        residual=balance.unbalanced_N / scale_N,
        penetration_mm=max(overlap_mm, -float(distance.min(initial=0.0))),
        support_N=balance.bond_N,
        cut_N=-relaxation.node_forces()[domain.fixed].sum(axis=0, dtype=np.float64),
        friction_ratio=friction_ratio,
        sliding=sliding,
    )


def point_displacement(domain: Domain, nodal: np.ndarray) -> np.ndarray:
    """Displacement of every surface point [mm], shape (P, 3)."""
    owner = np.repeat(domain.owners, np.diff(domain.owner_starts))
    nodes = (domain.rows[owner][:, :, None] + np.arange(3)).reshape(-1, 27)
    return np.einsum("pn,pnc->pc", domain.point_weights, nodal[nodes])


def deepest_overlap_mm(
    places_mm: np.ndarray, collider: Collider, origin: np.ndarray, rotation: np.ndarray
) -> float:
    """How deep the deepest of some places, (N, 3), lies inside the indenter [mm]; 0 if none."""
    body = places_mm - origin
    body = body[np.einsum("nc,nc->n", body, body) < collider.reach_mm**2]
    distance, _ = collider.distance(body @ rotation)
    return -float(distance.min(initial=0.0))


def _friction(
    forces: np.ndarray, normal: np.ndarray, *, friction: float
) -> tuple[float, np.ndarray]:
    """Largest tangential over normal force, and which points slide.

    Taken from the forces and the indenter's surface, not from the solver's own return to the cone.
    """
    normal = normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), LEAST)
    pressing = np.einsum("pc,pc->p", forces, normal)
    aside = np.linalg.norm(forces - pressing[:, None] * normal, axis=1)
    size = np.linalg.norm(forces, axis=1)
    pressed = size > LEAST_PRESSURE_SHARE * size.max(initial=0.0)
    ratio = aside / np.maximum(pressing, LEAST)
    return float(ratio[pressed].max(initial=0.0)), pressed & (ratio >= SLIDING_SHARE * friction)


def collect(
    outcomes: list[FrameOutcome],
    *,
    approach: Approach,
    domain: Domain,
    radius_mm: float,
    substeps: int,
) -> Contact:
    """All frames as one result."""

    def stack(name: str) -> np.ndarray:
        return np.stack([np.asarray(getattr(outcome, name)) for outcome in outcomes])

    return Contact(
        displacement_mm=stack("displacement_mm"),
        inner_mm=stack("inner_mm"),
        reaction_N=stack("reaction_N"),
        moment_Nmm=stack("moment_Nmm"),
        indenter_pose=stack("indenter_pose"),
        residual=stack("residual"),
        penetration_mm=stack("penetration_mm"),
        support_N=stack("support_N"),
        cut_N=stack("cut_N"),
        friction_ratio=stack("friction_ratio"),
        sliding=stack("sliding"),
        target_mm=approach.target_mm,
        normal=approach.normal,
        tangent_u=approach.tangent_u,
        grid_mm=domain.grid_mm,
        active_radius_mm=radius_mm,
        particles=domain.particles,
        substeps=substeps,
        device="cuda" if current_cfg().arch == ti.cuda else "cpu",
    )
