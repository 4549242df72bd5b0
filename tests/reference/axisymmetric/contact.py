"""Touch of a skin and a rigid object: a stiff penalty and Coulomb's friction along the section.

At eight Gauss points of every edge, per undeformed area: the pressure is eps max(-phi, 0), the
friction k e while that is below mu times the pressure, else mu times the pressure; e is the slip
kept before plus the way along the profile in this increment, and what a converged increment keeps
is friction / k. The tangent is that of this very rule. Source: Wriggers, Computational Contact
Mechanics, 2006, sections 5.2 and 10.5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.reference.axisymmetric.grids import Grid
from tests.reference.axisymmetric.profiles import Profile
from tests.reference.axisymmetric.solid import lagrange

POINTS = 8
"""Of an edge."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Skin:
    """Points of the skin, S edges with Q points and 2 n displacements each."""

    shape: np.ndarray
    """Of the nodes at the points, shape (Q, n)."""
    places_mm: np.ndarray
    """At rest, shape (S, Q, 2)."""
    area_mm2: np.ndarray
    """Of the ring of each point, shape (S, Q)."""
    unknowns: np.ndarray
    """Shape (S, 2 n)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Pair:
    """An object and how it touches."""

    profile: Profile
    friction: float
    penalty_MPa_mm: float
    stick_MPa_mm: float
    """k."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Kept:
    """What a converged increment leaves."""

    motion_mm: np.ndarray
    """Of the points, shape (S, Q, 2)."""
    depth_mm: float
    slip_mm: np.ndarray
    """Elastic slip, shape (S, Q)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Touch:
    """Forces on the skin at one pose."""

    force_N: np.ndarray
    """Shape (S, 2 n)."""
    tangent_N_mm: np.ndarray
    """Minus the derivative of the force, shape (S, 2 n, 2 n)."""
    kept: Kept
    pressing_N: float
    """Force on the object along the axis."""
    radius_mm: float
    """Of the outermost point in contact, deformed."""


def make_skin(grid: Grid) -> Skin:
    """The skin of a grid."""
    place, share = np.polynomial.legendre.leggauss(POINTS)
    shape, slope = lagrange(grid.order, place)
    nodes = grid.points_mm[grid.edges]
    places = np.einsum("qn,snd->sqd", shape, nodes)
    length = np.linalg.norm(np.einsum("qn,snd->sqd", slope, nodes), axis=2)
    unknowns = 2 * grid.edges[:, :, None] + np.arange(2)
    return Skin(
        shape=shape,
        places_mm=places,
        area_mm2=2.0 * np.pi * places[..., 0] * length * share,
        unknowns=unknowns.reshape(len(grid.edges), -1),
    )


def untouched(skin: Skin) -> Kept:
    """Before anything has moved."""
    return Kept(
        motion_mm=np.zeros_like(skin.places_mm), depth_mm=0.0, slip_mm=np.zeros(skin.area_mm2.shape)
    )


def touch(skin: Skin, pair: Pair, kept: Kept, motion_mm: np.ndarray, depth_mm: float) -> Touch:
    """Forces with the object's lowest point at z = -depth.

    Args:
        skin: The points.
        pair: The object.
        kept: From the increment before.
        motion_mm: Displacements, shape (2 N,).
        depth_mm: Of the object.
    """
    nodes = motion_mm[skin.unknowns].reshape(len(skin.unknowns), -1, 2)
    moved = np.einsum("qn,snd->sqd", skin.shape, nodes)
    count = moved.shape[:2]
    places = skin.places_mm + moved + [0.0, depth_mm]
    near = pair.profile(places.reshape(-1, 2))
    way = (moved - kept.motion_mm + [0.0, depth_mm - kept.depth_mm]).reshape(-1, 2)
    normal, along, kappa = near.normal, near.along, near.curvature_per_mm
    pressure = pair.penalty_MPa_mm * np.maximum(-near.distance_mm, 0.0)
    touching = pressure > 0.0
    slip = kept.slip_mm.ravel() + (way * along).sum(axis=1)
    limit = pair.friction * pressure
    sliding = pair.stick_MPa_mm * np.abs(slip) >= limit
    rub = np.where(sliding, limit * np.sign(slip), pair.stick_MPa_mm * slip)
    turning = 1.0 - kappa * (way * normal).sum(axis=1)
    # d(rub) = by_normal (n.dx) + by_along (t.dx); d n = kappa t (t.dx), d t = -kappa n (t.dx).
    by_normal = np.where(sliding, -pair.friction * pair.penalty_MPa_mm * np.sign(slip), 0.0)
    by_along = np.where(sliding, 0.0, pair.stick_MPa_mm * turning)
    by_normal, by_along = (np.where(touching, x, 0.0) for x in (by_normal, by_along))
    stiffness = np.stack(
        [
            np.stack([pair.penalty_MPa_mm * touching, -rub * kappa], axis=1),
            np.stack([by_normal, by_along - pressure * kappa], axis=1),
        ],
        axis=1,
    )
    frame = np.stack([normal, along], axis=1)
    stiffness = np.swapaxes(frame, 1, 2) @ stiffness @ frame
    traction = (pressure[:, None] * normal - rub[:, None] * along).reshape(*count, 2)
    force = np.einsum("sq,qn,sqd->snd", skin.area_mm2, skin.shape, traction)
    tangent = np.einsum(
        "sq,qn,qm,sqde->sndme",
        skin.area_mm2,
        skin.shape,
        skin.shape,
        stiffness.reshape(*count, 2, 2),
        optimize=True,
    )
    radii = places[..., 0].ravel()[touching]
    return Touch(
        force_N=force.reshape(len(force), -1),
        tangent_N_mm=tangent.reshape(len(force), skin.unknowns.shape[1], -1),
        kept=Kept(
            motion_mm=moved,
            depth_mm=depth_mm,
            slip_mm=np.where(touching, rub / pair.stick_MPa_mm, 0.0).reshape(count),
        ),
        pressing_N=float(-(skin.area_mm2 * traction[..., 1]).sum()),
        radius_mm=float(radii.max(initial=0.0)),
    )
