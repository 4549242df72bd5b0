"""One force result, whatever found it: material points, finite elements, or the learned network.

Fields have the names, units and signs that they have in `Contact`, so what shows the one shows the
other. K frames, V outer-skin vertices, W inner ones; what a source does not know has length 0.
"""

from __future__ import annotations

import enum
from dataclasses import dataclass, field

import numpy as np

from workbench.core.result.sensing import Contact


class Source(enum.StrEnum):
    """What found the forces."""

    MPM = "mpm"
    """The contact solver, by material points."""
    FEM = "fem"
    """Finite elements: the ground truth."""
    LEARNED = "learned"
    """The sparse tensor network, from the displacement of the contact solver."""


def _none(*shape: int) -> np.ndarray:
    return np.zeros(shape, dtype=np.float32)


@dataclass(frozen=True, kw_only=True, slots=True)
class ForceField:
    """Forces and displacements of the outer skin, frame by frame, in the sensor frame."""

    source: Source
    displacement_mm: np.ndarray
    """Displacement of the outer skin's vertices [mm], shape (K, V, 3), float32."""
    contact_force_N: np.ndarray
    """Force of the object on the skin at its vertices [N], shape (K, V, 3), float32."""
    reaction_N: np.ndarray
    """Force on the object [N], shape (K, 3), float64: minus the sum of the above."""
    target_mm: np.ndarray
    """Target on the undeformed skin [mm], shape (3,)."""
    normal: np.ndarray
    """Outward unit normal there, shape (3,)."""
    tangent_u: np.ndarray
    """Unit U of the tangent plane, shape (3,)."""
    indenter_pose: np.ndarray
    """x, y, z [mm], qw, qx, qy, qz of the object, shape (K, 7), float64."""
    residual: np.ndarray
    """Relative out-of-balance force, shape (K,); NaN of what is not solved for: learned forces."""
    balance: np.ndarray
    """Missing force between object and what holds the skin, over the load, (K,); NaN likewise."""
    converged: np.ndarray
    """Whether every increment up to each frame reached its tolerance, shape (K,), bool."""
    moment_Nmm: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Moment on the object about its own origin [N mm], shape (K, 3), float64."""
    pressure_MPa: np.ndarray = field(default_factory=lambda: _none(0, 0))
    """Contact force along the object's normal per undeformed area of the vertex, (K, V)."""
    cauchy_MPa: np.ndarray = field(default_factory=lambda: _none(0, 0, 6))
    """Cauchy stress at the outer vertices: xx, yy, zz, xy, yz, zx, shape (K, V, 6)."""
    energy_MPa: np.ndarray = field(default_factory=lambda: _none(0, 0))
    """Strain energy per undeformed volume at the outer vertices [MPa], shape (K, V)."""
    sliding: np.ndarray = field(default_factory=lambda: np.zeros((0, 0), dtype=bool))
    """Outer vertices around which most of the contact slides (`sim.forces.slip`), (K, V), bool."""
    sliding_share: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Share of the contact's area that slides, of what touched at both ends of the frame, (K,)."""
    slip_mm: np.ndarray = field(default_factory=lambda: _none(0, 0))
    """Way that each vertex has slid on the object since it first touched [mm], shape (K, V)."""
    inner_mm: np.ndarray = field(default_factory=lambda: _none(0, 0, 3))
    """Displacement of the inner skin's vertices [mm], shape (K, W, 3), float32."""
    support_N: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Force of the rigid support and of gel on the membrane [N], shape (K, 3), float64."""
    cut_N: np.ndarray = field(default_factory=lambda: np.zeros((0, 3)))
    """Force of elastomer that took no part on the part that did [N], shape (K, 3)."""
    actuator_N: np.ndarray = field(default_factory=lambda: np.zeros((0, 0, 3)))
    """Force of each driven region's drive on the membrane [N], shape (K, A, 3)."""
    penetration_mm: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Deepest overlap of skin and object [mm], shape (K,)."""
    friction_ratio: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Largest pointwise tangential over normal contact force, shape (K,)."""
    least_volume_ratio: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Least J = det F, shape (K,)."""
    increments: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Increments that each frame took, shape (K,)."""
    steps: np.ndarray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    """Linear systems that each frame took, shape (K,)."""
    frame_seconds: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Time each frame took [s], shape (K,); differs from run to run."""
    force_error: np.ndarray = field(default_factory=lambda: np.zeros(0))
    """Estimated relative error of the reaction's size, positive where it is too large, shape (K,);
    NaN where the coarser mesh gave none."""
    radius_mm: float = 0.0
    """Radius of the part that took part, about the target [mm]."""
    spacing_mm: float = 0.0
    """Edge of a cell of the mesh or grid [mm]; 0 for learned forces."""
    solver: str = ""
    """What solved or predicted it, for people."""
    notice: str = ""
    """Why not to trust it, for people: a design that the weights do not know."""
    note: str = ""
    """What was done to it that is no reason for doubt, for people: forces scaled with E."""

    @property
    def normal_N(self) -> np.ndarray:
        """Reaction along the outward target normal [N], shape (K,)."""
        return self.reaction_N @ self.normal

    @property
    def tangential_N(self) -> np.ndarray:
        """Size of the reaction across the target normal [N], shape (K,)."""
        across = self.reaction_N - np.outer(self.normal_N, self.normal)
        return np.linalg.norm(across, axis=1)


def from_contact(contact: Contact) -> ForceField:
    """The forces of the contact solver."""
    load_N = np.linalg.norm(contact.reaction_N, axis=1)
    held_N = contact.support_N + contact.cut_N + contact.actuator_N.sum(axis=1)
    missing_N = np.linalg.norm(contact.reaction_N - held_N, axis=1)
    return ForceField(
        source=Source.MPM,
        displacement_mm=contact.displacement_mm,
        contact_force_N=contact.contact_force_N,
        reaction_N=contact.reaction_N,
        target_mm=contact.target_mm,
        normal=contact.normal,
        tangent_u=contact.tangent_u,
        indenter_pose=contact.indenter_pose,
        residual=contact.residual,
        balance=missing_N / np.maximum(load_N, 1e-12),
        converged=np.ones(len(load_N), dtype=bool),
        moment_Nmm=contact.moment_Nmm,
        pressure_MPa=contact.pressure_MPa,
        cauchy_MPa=contact.cauchy_MPa,
        energy_MPa=contact.energy_MPa,
        sliding=contact.sliding,
        sliding_share=contact.sliding_share,
        slip_mm=contact.slip_mm,
        inner_mm=contact.inner_mm,
        support_N=contact.support_N,
        cut_N=contact.cut_N,
        actuator_N=contact.actuator_N,
        penetration_mm=contact.penetration_mm,
        friction_ratio=contact.friction_ratio,
        least_volume_ratio=contact.least_volume_ratio,
        frame_seconds=contact.frame_seconds,
        radius_mm=contact.active_radius_mm,
        spacing_mm=contact.grid_mm,
        solver=f"material points on {contact.device}",
    )
