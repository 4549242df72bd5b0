"""Skins with a gap behind them: gel or air between the skin and the rigid window.

The gel is a Winkler foundation: every point of the skin's inner face is held to its place by a
spring per area k = E_gel / gap, the stiffness of a column of gel that may bulge freely. It is a
lower bound for a thin layer, which cannot bulge. Sideways the column is sheared instead, by
G_gel / gap = k / (2 (1 + nu)), a third of k for gel that keeps its volume. Pins
hang free in the gel, which moves with them. With air (E_gel = 0) only the clamped rim holds the
skin.

A plate of thickness t on such a foundation bends within the length l = (D / k)^(1/4),
D = E t^3 / (12 (1 - nu^2)). Source: Timoshenko and Woinowsky-Krieger, Theory of Plates and
Shells, chapter 8.
Left out: gel that pushes sideways, pins that touch the window.
"""

from __future__ import annotations

import math

import numpy as np

from workbench.core.design.design import Elastomer
from workbench.core.result.results import Label, MembraneMesh

SIDEWAYS = 1.0 / 3.0
"""Shear over Young's modulus of gel, 1 / (2 (1 + nu)) at nu = 0.5."""
DECAY_LENGTHS = 4.0
"""Lengths l after which a plate on a foundation is at rest: exp(-4 / sqrt 2) = 6 %, and the
curvature of the shell shortens it further."""


def bonded_faces(mesh: MembraneMesh) -> np.ndarray:
    """Inner faces bonded to the rigid support, shape (F,), bool."""
    return (mesh.inner.labels & Label.BACKED) == 0


def backed_faces(mesh: MembraneMesh) -> np.ndarray:
    """Inner faces that rest on the gel, shape (F,), bool; pins do not."""
    return ~bonded_faces(mesh) & ((mesh.inner.labels & Label.PIN) == 0)


def foundation_N_mm3(mesh: MembraneMesh, material: Elastomer) -> float:
    """Spring of the gel per area, E_gel / gap [N/mm3]; 0 for air or where there is no gap."""
    return material.backing_MPa / mesh.backing_mm if mesh.backing_mm > 0.0 else 0.0


def decay_mm(mesh: MembraneMesh, material: Elastomer, wall_mm: float) -> float:
    """How far beyond the contact a backed skin moves [mm]: 0 where bonded, inf over air."""
    if mesh.backing_mm == 0.0:
        return 0.0
    spring = foundation_N_mm3(mesh, material)
    if spring == 0.0:
        return math.inf
    plate_Nmm = material.young_MPa * wall_mm**3 / (12.0 * (1.0 - material.poisson**2))
    return DECAY_LENGTHS * (plate_Nmm / spring) ** 0.25


def support_points_mm(mesh: MembraneMesh) -> np.ndarray:
    """Points of the rigid support that an object must not reach [mm], shape (N, 3).

    Bonded vertices lie on it; backed ones are a gap away from it along the normals of the skin
    without its pins: the sides of a pin would tilt the normals at its root.
    """
    from geometry.surface.surface import vertex_normals

    inner = mesh.inner
    bonded = np.unique(inner.faces[bonded_faces(mesh)])
    resting = inner.faces[backed_faces(mesh)]
    backed, normals = np.unique(resting), vertex_normals(inner.points_mm, resting)
    window = inner.points_mm[backed] - mesh.backing_mm * normals[backed]
    return np.concatenate([inner.points_mm[bonded], window])
