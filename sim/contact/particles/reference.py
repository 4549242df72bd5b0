"""Plain NumPy twin of `particle_kernels`, in double precision and without fixed-point sums."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import line_weights

FREE = 3


@dataclass(kw_only=True, slots=True)
class Points:
    """Material points in cells, substeps and full points; changed in place."""

    place: np.ndarray
    """Shape (P, 3)."""
    speed: np.ndarray
    affine: np.ndarray
    """Affine velocity C, shape (P, 3, 3)."""
    gradient: np.ndarray
    """Deformation gradient F, shape (P, 3, 3)."""
    mass: np.ndarray
    moduli_MPa: np.ndarray
    """Shear and bulk modulus, shape (P, 2)."""
    kind: np.ndarray
    """OBJECT, SUPPORT, BORDER or FREE, shape (P,)."""
    given: np.ndarray
    """Prescribed speed of points that are not free, shape (P, 3)."""


def kirchhoff(gradient: np.ndarray, moduli_MPa: np.ndarray) -> np.ndarray:
    """tau = mu J^(-2/3) dev(F F^T) + K (J - 1) J I, shape (P, 3, 3)."""
    ratio = np.linalg.det(gradient)
    left = gradient @ gradient.transpose(0, 2, 1)
    scale = moduli_MPa[:, 0] * ratio ** (-2.0 / 3.0)
    pressure = moduli_MPa[:, 1] * (ratio - 1.0) * ratio - scale * np.trace(left.T) / 3.0
    return scale[:, None, None] * left + pressure[:, None, None] * np.eye(3)


def substep(points: Points, nodes: tuple[int, int, int], stress_scale: float) -> np.ndarray:
    """Move all points by one substep; returns the momentum that each prescribed one gained."""
    first = np.floor(points.place - 0.5).astype(int)
    local = points.place - first
    weights = line_weights(local - 1.0)
    carried = points.affine - 4.0 * stress_scale * kirchhoff(points.gradient, points.moduli_MPa)
    mass, momentum = np.zeros(nodes), np.zeros((*nodes, 3))
    stencil = []
    for i, j, k in itertools.product(range(3), repeat=3):
        weight = weights[:, 0, i] * weights[:, 1, j] * weights[:, 2, k] * points.mass
        arm = np.array([i, j, k]) - local
        node = tuple((first + np.array([i, j, k])).T)
        added = weight[:, None] * (points.speed + np.einsum("prc,pc->pr", carried, arm))
        np.add.at(mass, node, weight)
        np.add.at(momentum, node, added)
        stencil.append((weight / points.mass, arm, node))
    grid = momentum / np.maximum(mass, 1e-300)[..., None]
    speed, slope = np.zeros_like(points.place), np.zeros_like(points.affine)
    for weight, arm, node in stencil:
        moved = weight[:, None] * grid[node]
        speed += moved
        slope += 4.0 * moved[:, :, None] * arm[:, None, :]
    points.gradient += slope @ points.gradient
    held = points.kind != FREE
    gained = points.mass[:, None] * (speed - points.given) * held[:, None]
    points.speed = np.where(held[:, None], points.given, speed)
    points.affine = np.where(held[:, None, None], 0.0, slope)
    points.place = points.place + points.speed
    return gained
