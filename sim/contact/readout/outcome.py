"""From the state of a settled frame to the numbers of `Contact`."""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any

import numpy as np
import taichi as ti
from taichi.lang.impl import current_cfg

from sim.contact.engine.balances import Balance
from sim.contact.grid.stencil import point_weights
from sim.contact.readout.fields import skin_stress, volume_state
from sim.contact.readout.frame import FrameOutcome, deepest_overlap_mm
from sim.contact.readout.problem import Problem
from sim.contact.region.domain import Domain, stencil_nodes
from workbench.core.base.frames import quaternion
from workbench.core.result.sensing import Contact

LEAST = 1e-12
"""Guards quotients of vanishing forces and slopes."""
LEAST_PRESSURE_SHARE = 1e-3
"""Points that carry less than this share of the largest normal force have no friction ratio."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SettledFrame:
    """A frame of a press in which forces balance, as it leaves the device; not yet committed."""

    number: int
    """Which frame, from 0."""
    balance: Balance
    """Forces of the state."""
    load_N: float
    """Force that the residual is relative to, the same as for the stop test."""
    seconds: float
    """Time that it took [s]."""
    nodal_mm: np.ndarray
    """Displacement of the region's nodes [mm], shape (N, 3), float32."""
    point_forces_N: np.ndarray
    """Force on the membrane at every surface point [N], shape (P, 3), float32."""
    cut_N: np.ndarray
    """Force of elastomer that took no part on the part that did [N], shape (3,)."""


def frame_outcome(
    problem: Problem,
    frame: SettledFrame,
    *,
    met: tuple[np.ndarray, np.ndarray] | None = None,
) -> FrameOutcome:
    """Read a settled frame: plain arrays in, so that another process may do it.

    Args:
        problem: The press.
        frame: What settled.
        met: Distances [mm], (P,), and outward directions, (P, 3), of the object at the points
            that may meet it, where it is not where its pose has it: it is soft.
    """
    balance, domain = frame.balance, problem.domain
    origin, rotation = problem.approach.pose(frame.number + 1.0)
    nodal = frame.nodal_mm.astype(np.float64)
    displacement = domain.outer.displacement_mm(nodal)
    inner = domain.inner
    point_forces = frame.point_forces_N.astype(np.float64)
    place = domain.points.position_mm + point_displacement(domain, nodal)
    touching = ~domain.points.bonded
    points, forces, at = domain.points.take(touching), point_forces[touching], place[touching]
    overlap_mm = 0.0
    if met is None:
        distance, gradient = problem.collider.distance((at - origin) @ rotation)
        met = distance, gradient @ rotation.T
        vertex_mm = problem.mesh.outer.points_mm + displacement
        overlap_mm = deepest_overlap_mm(vertex_mm, problem.collider, origin, rotation)
    distance, normal = met[0], _unit(met[1])
    pressing = np.einsum("pc,pc->p", forces, normal)
    aside = np.linalg.norm(forces - pressing[:, None] * normal, axis=1)
    count = domain.outer.count
    area_mm2 = np.maximum(points.to_vertices(points.area_mm2, count), LEAST)
    drives = _drives(problem, point_forces, place)
    held = domain.points.bonded & (domain.points.drive < 0)
    volume = volume_state(domain, nodal)
    cauchy, energy = skin_stress(domain, nodal)
    return FrameOutcome(
        displacement_mm=displacement,
        inner_mm=np.zeros((0, 3), np.float32) if inner is None else inner.displacement_mm(nodal),
        reaction_N=balance.reaction_N,
        moment_Nmm=-np.cross(at - origin, forces).sum(axis=0),
        indenter_pose=np.concatenate([origin, quaternion(rotation)]),
        residual=balance.unbalanced_N / frame.load_N,
        penetration_mm=max(overlap_mm, -float(distance.min(initial=0.0))),
        support_N=point_forces[held].sum(axis=0),
        support_moment_Nmm=np.cross(place[held], point_forces[held]).sum(axis=0),
        cut_N=frame.cut_N,
        actuator_N=drives[0],
        actuator_moment_Nmm=drives[1],
        friction_ratio=_friction_ratio(pressing, aside),
        contact_force_N=points.to_vertices(forces, count).astype(np.float32),
        pressure_MPa=(points.to_vertices(pressing, count) / area_mm2).astype(np.float32),
        tangential_N=float(aside.sum()),
        pressing_N=float(pressing.sum()),
        cauchy_MPa=cauchy,
        energy_MPa=energy,
        strain_energy_Nmm=volume.strain_energy_Nmm,
        kinetic_ratio=0.5 * balance.inertia_Nmm / max(volume.strain_energy_Nmm, LEAST),
        least_volume_ratio=volume.least_volume_ratio,
        frame_seconds=frame.seconds,
    )


def point_displacement(domain: Domain, nodal: np.ndarray) -> np.ndarray:
    """Displacement of every surface point [mm], shape (P, 3)."""
    owner = np.repeat(domain.owners, np.diff(domain.owner_starts))
    nodes = stencil_nodes(domain.rows[owner])
    return np.einsum("pn,pnc->pc", point_weights(domain.point_local), nodal[nodes])


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), LEAST)


def _friction_ratio(pressing: np.ndarray, aside: np.ndarray) -> float:
    """Largest tangential over normal force of a point.

    Taken from the forces and the object's surface, not from the solver's own return to the cone.
    """
    size = np.hypot(pressing, aside)
    pressed = size > LEAST_PRESSURE_SHARE * size.max(initial=0.0)
    ratio = aside[pressed] / np.maximum(pressing[pressed], LEAST)
    return float(ratio.max(initial=0.0))


def _drives(
    problem: Problem, forces: np.ndarray, place: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Force [N] and moment about its axis point [N mm] of each drive on the membrane, (A, 3)."""
    found = []
    for number, actuation in enumerate(problem.press.actuations):
        members = problem.domain.points.drive == number
        arm = place[members] - np.asarray(actuation.about_mm)
        found.append((forces[members].sum(axis=0), np.cross(arm, forces[members]).sum(axis=0)))
    pairs = np.array(found).reshape(-1, 2, 3)
    return pairs[:, 0], pairs[:, 1]


def collect(outcomes: list[FrameOutcome], problem: Problem, *, substeps: int) -> Contact:
    """All frames as one result."""
    stacked: dict[str, Any] = {
        field.name: np.stack([np.asarray(getattr(outcome, field.name)) for outcome in outcomes])
        for field in fields(FrameOutcome)
    }
    approach = problem.approach
    return Contact(
        **stacked,
        target_mm=approach.target_mm,
        normal=approach.normal,
        # A press that failed has fewer frames than its path.
        sensor_pose=approach.sensor_poses()[: len(outcomes)],
        tangent_u=approach.tangent_u,
        grid_mm=problem.domain.grid_mm,
        active_radius_mm=problem.radius_mm,
        particles=problem.domain.particles,
        substeps=substeps,
        device="cuda" if current_cfg().arch == ti.cuda else "cpu",
    )
