"""Adaptive dynamic relaxation: damped motion with fictitious masses until forces balance.

    v <- ((2 - d) v + 2 f / m) / (2 + d),  u <- u + v,  d = 2 sqrt(l),  l = v.(f_old - f) / v.m v

with a time step of 1; l, the Rayleigh quotient of the last step, estimates the lowest frequency
that is still moving. Source: Underwood, Dynamic relaxation, 1983; Papadrakakis, 1981.
Nothing bulky leaves the device while it relaxes: sums come back as partial sums of fixed chunks.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import taichi as ti

from sim.contact import kernels
from sim.contact.collider import Collider
from sim.contact.domain import Domain
from sim.material import NeoHookean

STEP_CAP = 0.1
"""Largest displacement of a node in one substep and axis, in cells."""
FIRST_DAMPING = 0.5
DAMPING_RANGE = (0.004, 1.5)
BATCH = 20
"""Most substeps between two looks at the residual."""

Pose = tuple[np.ndarray, np.ndarray]


@dataclass(frozen=True, kw_only=True, slots=True)
class Balance:
    """Forces [N] at one moment."""

    reaction_N: np.ndarray
    """Force on the indenter, shape (3,)."""
    bond_N: np.ndarray
    """Force of the bonded points on the membrane, shape (3,)."""
    unbalanced_N: float
    """Euclidean norm of the forces on free nodes."""
    net_N: np.ndarray
    """Sum of the forces on free nodes, shape (3,)."""

    @property
    def finite(self) -> bool:
        """Whether no force has overflowed."""
        forces = [self.unbalanced_N, *self.reaction_N, *self.bond_N, *self.net_N]
        return bool(np.isfinite(forces).all())


class Relaxation:
    """Displacement, velocity and contact history of one press on the device."""

    def __init__(
        self, domain: Domain, collider: Collider, solid: NeoHookean, *, friction: float
    ) -> None:
        self.domain = domain
        self.damping = FIRST_DAMPING
        self.mass_scale = 1.0
        self.substeps = 0
        self.collider = collider
        self._solid = solid
        self.friction = friction
        self._moved = False
        nodes, points = len(domain.masses), len(domain.points.vertex)
        slots = (len(domain.rows) // kernels.BLOCK + 1) * kernels.BLOCK * 81
        self._displacement = _floats(np.zeros(3 * nodes))
        self._velocity = _floats(np.zeros(3 * nodes))
        self._forces = _floats(np.zeros(3 * nodes))
        self._slots = _floats(np.zeros(slots))
        self._rows = _integers(domain.rows)
        self._volumes = _floats(domain.volumes_mm3)
        self._node_starts = _integers(domain.node_starts)
        self._node_slots = _integers(domain.node_slots)
        self._masses = _floats(domain.masses)
        self._fixed = _integers(domain.fixed)
        self._powers = _floats(np.zeros(2 * nodes))
        self._owners = _integers(domain.owners)
        self._owner_starts = _integers(domain.owner_starts)
        self._weights = _floats(domain.point_weights)
        self._positions = _floats(domain.points.position_mm - domain.target_mm)
        self._stiffness = _floats(domain.points.stiffness_N_mm)
        self._axes = _floats(domain.points.axis)
        self._sideways = _floats(domain.points.sideways)
        self._bonded = _integers(domain.points.bonded)
        self._anchors = _floats(np.zeros(3 * points))
        self._states = _integers(np.zeros(points))
        self._point_forces = _floats(np.zeros(3 * points))
        self._poses = _floats(np.zeros(12 * BATCH))
        self._size = _floats(collider.size)
        self._coefficients = _floats(collider.samples)
        self._counts = _integers(np.array(collider.samples.shape))
        self._node_partial = ti.ndarray(ti.f64, 6 * _chunks(nodes))
        self._surface_partial = ti.ndarray(ti.f64, 6 * _chunks(points))

    def advance(self, poses: list[Pose]) -> None:
        """One substep at each pose, at most `BATCH` of them."""
        self._upload(poses)
        for step in range(len(poses)):
            self._substep(step, moving=True)
        self.substeps += len(poses)

    def evaluate(self, pose: Pose) -> Balance:
        """Forces at the present displacement; nothing moves."""
        self._upload([pose])
        self._substep(0, moving=False)
        return self.balance()

    def balance(self) -> Balance:
        """Forces of the last substep; also adapts the damping for the next ones."""
        kernels.node_sums(self._forces, self._powers, self._fixed, self._node_partial)
        kernels.surface_sums(self._point_forces, self._bonded, self._surface_partial)
        work, inertia, square, *net = _total(self._node_partial)
        surface = _total(self._surface_partial)
        if self._moved and inertia > 0.0:
            lowest = max(work / inertia, 0.0)
            self.damping = float(np.clip(2.0 * np.sqrt(lowest), *DAMPING_RANGE))
        return Balance(
            reaction_N=-surface[:3],
            bond_N=surface[3:],
            unbalanced_N=float(np.sqrt(square)),
            net_N=np.array(net),
        )

    def commit(self, pose: Pose) -> None:
        """Make the anchors of this settled frame the friction history of the next."""
        self._upload([pose])
        kernels.commit_anchors(
            self._displacement, self._rows, self._owners, self._owner_starts, self._weights,
            self._positions, self._bonded, self._anchors, self._states, self._poses, self._size,
            self._coefficients, self._counts, 0, int(self.collider.shape), self.friction,
        )  # fmt: skip

    def restart(self, displacement_mm: np.ndarray) -> None:
        """Come to rest at a nodal displacement, shape (N, 3); anchors of this frame are lost."""
        states = self._states.to_numpy()
        self._states.from_numpy(np.where(states == kernels.HELD, states, kernels.FREE))
        self._displacement.from_numpy(np.ascontiguousarray(displacement_mm, np.float32).ravel())
        self._velocity.fill(0.0)
        self._moved = False
        self.damping = FIRST_DAMPING

    def displacement(self) -> np.ndarray:
        """Nodal displacement [mm], shape (N, 3), float32."""
        return self._displacement.to_numpy().reshape(-1, 3)

    def node_forces(self) -> np.ndarray:
        """Force on every node [N], shape (N, 3), float32."""
        return self._forces.to_numpy().reshape(-1, 3)

    def point_forces(self) -> np.ndarray:
        """Force on the membrane at every surface point [N], shape (P, 3), float32."""
        return self._point_forces.to_numpy().reshape(-1, 3)

    def contact_history(self) -> tuple[np.ndarray, np.ndarray]:
        """Anchors in the body frame [mm], (P, 3), and states, (P,), of all surface points."""
        return self._anchors.to_numpy().reshape(-1, 3), self._states.to_numpy()

    def _upload(self, poses: list[Pose]) -> None:
        table = np.zeros((BATCH, 12), np.float32)
        for row, (origin, rotation) in zip(table, poses, strict=False):
            row[:3], row[3:] = origin - self.domain.target_mm, rotation.ravel()
        self._poses.from_numpy(table.ravel())

    def _substep(self, step: int, *, moving: bool) -> None:
        grid_mm = self.domain.grid_mm
        kernels.substep(
            self._displacement, self._velocity, self._forces, self._slots, self._rows,
            self._volumes, self._node_starts, self._node_slots, self._masses, self._fixed,
            self._powers, self._owners, self._owner_starts, self._weights, self._positions,
            self._stiffness, self._axes, self._sideways, self._bonded, self._anchors, self._states,
            self._point_forces, self._poses, self._size, self._coefficients, self._counts,
            step, int(self.collider.shape), int(moving), 1.0 / grid_mm, self._solid.shear_MPa,
            self._solid.bulk_MPa, self.friction, self.mass_scale, self.damping,
            STEP_CAP * grid_mm,
        )  # fmt: skip
        self._moved = moving


def _chunks(rows: int) -> int:
    return max(1, -(-rows // kernels.CHUNK))


def _total(partial: Any) -> np.ndarray:
    return partial.to_numpy().reshape(-1, 6).sum(axis=0)


def _floats(values: np.ndarray) -> Any:
    return _device(values, ti.f32, np.float32)


def _integers(values: np.ndarray) -> Any:
    return _device(values, ti.i32, np.int32)


def _device(values: np.ndarray, kind: Any, host: type) -> Any:
    # Taichi has no empty arrays: an empty one is a single number that no kernel reads.
    flat = np.ascontiguousarray(values, dtype=host).ravel()
    array = ti.ndarray(kind, max(1, flat.size))
    array.from_numpy(flat if flat.size else np.zeros(1, host))
    return array
