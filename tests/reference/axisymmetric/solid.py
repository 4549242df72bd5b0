"""Quadrilaterals of revolution of a nearly incompressible neo-Hookean solid at finite strain.

    W = mu / 2 (J^(-2/3) tr(F^T F) - 3) + K / 2 (theta - 1)^2,

theta the projection of J, in the undeformed volume, on polynomials of one element alone: linear
in r and z for the nine-noded quadrilateral (Q2/P1disc), constant for the four-noded one (Q1/P0).
That is the mixed method of displacement and pressure p = K (theta - 1) with the pressure
eliminated, so that what is left is an energy of displacements. Both tend to the solid with J for
theta. In a section F has five entries, f = (F_rr, F_rz, F_zr, F_zz, 1 + u_r / r).
Source: Simo, Taylor and Pister, Comp. Meth. Appl. Mech. Eng. 51, 1985; Boffi, Brezzi and Fortin,
Mixed Finite Element Methods, 2013, section 8.6 (Q2/P1disc is stable for linears in r and z).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from tests.reference.axisymmetric.grids import Grid

REST = np.array([1.0, 0.0, 0.0, 1.0, 1.0])


@dataclass(frozen=True, kw_only=True, slots=True)
class Solid:
    """Elements at rest: E of them with G points and D displacements each."""

    slopes_per_mm: np.ndarray
    """f by the displacements, shape (E, G, 5, D)."""
    volume_mm3: np.ndarray
    """Of the ring of each point, shape (E, G)."""
    modes: np.ndarray
    """Polynomials that carry theta, shape (E, G, M)."""
    inverse: np.ndarray
    """Inverse of their mass [1/mm3], shape (E, M, M)."""
    unknowns: np.ndarray
    """Numbers of the displacements of each element, shape (E, D)."""
    shear_MPa: float
    bulk_MPa: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Response:
    """Of all elements to displacements."""

    energy_N_mm: float
    force_N: np.ndarray
    """Shape (E, D)."""
    tangent_N_mm: np.ndarray | None
    """Shape (E, D, D); where it was asked for."""
    least_ratio: float
    """Smallest J of all points."""


def lagrange(order: int, places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Lagrange's polynomials on [-1, 1] and their slopes at places, shapes (P, order + 1)."""
    x = places
    if order == 1:
        return np.stack([1 - x, 1 + x], axis=1) / 2, np.tile([-0.5, 0.5], (len(x), 1))
    values = np.stack([x * (x - 1) / 2, 1 - x * x, x * (x + 1) / 2], axis=1)
    return values, np.stack([x - 0.5, -2 * x, x + 0.5], axis=1)


def make_solid(grid: Grid, shear_MPa: float, bulk_MPa: float) -> Solid:
    """Elements of a grid, with (order + 1)^2 Gauss points."""
    place, share = np.polynomial.legendre.leggauss(grid.order + 1)
    value, slope = lagrange(grid.order, place)
    nodes = (grid.order + 1) ** 2
    shape, by_first, by_second = (
        np.einsum("hj,gi->hgji", second, first).reshape(-1, nodes)
        for second, first in ((value, value), (value, slope), (slope, value))
    )
    corners = grid.points_mm[grid.cells]
    local = np.stack([by_first, by_second], axis=1)
    jacobian = np.einsum("gan,end->egad", local, corners)
    per_mm = np.linalg.solve(jacobian, np.broadcast_to(local, (len(corners), *local.shape)))
    spots = np.einsum("gn,end->egd", shape, corners)
    radius_mm = spots[..., 0]
    area = np.abs(np.linalg.det(jacobian)) * np.outer(share, share).ravel()
    slopes = np.zeros((*radius_mm.shape, 5, nodes, 2))
    slopes[..., 0, :, 0] = slopes[..., 2, :, 1] = per_mm[:, :, 0]
    slopes[..., 1, :, 0] = slopes[..., 3, :, 1] = per_mm[:, :, 1]
    slopes[..., 4, :, 0] = shape / radius_mm[..., None]
    volume = 2.0 * np.pi * radius_mm * area
    modes = np.ones((*radius_mm.shape, 1))
    if grid.order == 2:
        middle, width = corners.mean(axis=1), np.ptp(corners, axis=1)
        modes = np.concatenate([modes, (spots - middle[:, None]) / width[:, None]], axis=2)
    mass = np.einsum("eg,ega,egb->eab", volume, modes, modes)
    return Solid(
        slopes_per_mm=slopes.reshape(*radius_mm.shape, 5, 2 * nodes),
        volume_mm3=volume,
        modes=modes,
        inverse=np.linalg.inv(mass),
        unknowns=(2 * grid.cells[:, :, None] + np.arange(2)).reshape(len(grid.cells), -1),
        shear_MPa=shear_MPa,
        bulk_MPa=bulk_MPa,
    )


def respond(solid: Solid, motion_mm: np.ndarray, *, tangent: bool = True) -> Response:
    """Energy, forces and tangent at displacements, shape (2 N,)."""
    slopes, volume, modes = solid.slopes_per_mm, solid.volume_mm3, solid.modes
    f = np.einsum("egkd,ed->egk", slopes, motion_mm[solid.unknowns], optimize=True) + REST
    ratio, cofactor, _ = _ratio(f)
    theta = np.einsum(
        "ega,eab,ehb,eh,eh->eg", modes, solid.inverse, modes, volume, ratio, optimize=True
    )
    pressure = solid.bulk_MPa * (theta - 1.0)
    count, points, _, unknowns = slopes.shape
    flat = slopes.reshape(count, 5 * points, unknowns).transpose(0, 2, 1)
    root = ratio ** (-2.0 / 3.0)
    square = (f * f).sum(axis=-1)
    stress = solid.shear_MPa * (
        root[..., None] * f - (root * square / ratio / 3.0)[..., None] * cofactor
    )
    weighted = volume[..., None] * (stress + pressure[..., None] * cofactor)
    stored = 0.5 * solid.shear_MPa * (root * square - 3.0)
    stored += 0.5 * solid.bulk_MPa * (theta - 1.0) ** 2
    return Response(
        energy_N_mm=float((volume * stored).sum()),
        force_N=(flat @ weighted.reshape(count, 5 * points, 1))[..., 0],
        tangent_N_mm=_tangent(solid, f, pressure) if tangent else None,
        least_ratio=float(ratio.min()),
    )


def _tangent(solid: Solid, f: np.ndarray, pressure: np.ndarray) -> np.ndarray:
    """Second derivatives of the energy by the displacements, shape (E, D, D)."""
    slopes, volume = solid.slopes_per_mm, solid.volume_mm3
    _, cofactor, curve = _ratio(f)
    moduli = solid.shear_MPa * _isochoric_moduli(f) + pressure[..., None, None] * curve
    count, points, _, unknowns = slopes.shape
    flat = slopes.reshape(count, 5 * points, unknowns)
    moved = (volume[..., None, None] * moduli) @ slopes
    tangent = flat.transpose(0, 2, 1) @ moved.reshape(flat.shape)
    growth = (cofactor[..., None, :] @ slopes)[:, :, 0]
    mean = (volume[..., None] * solid.modes).transpose(0, 2, 1) @ growth
    return tangent + solid.bulk_MPa * (mean.transpose(0, 2, 1) @ solid.inverse @ mean)


def _ratio(f: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """J, its slope and its second derivatives by f: (...,), (..., 5), (..., 5, 5)."""
    a, b, c, d, hoop = np.moveaxis(f, -1, 0)
    plane = a * d - b * c
    slope = np.stack([d * hoop, -c * hoop, -b * hoop, a * hoop, plane], axis=-1)
    curve = np.zeros((*plane.shape, 5, 5))
    curve[..., 0, 3] = curve[..., 3, 0] = hoop
    curve[..., 1, 2] = curve[..., 2, 1] = -hoop
    for entry, other in enumerate((d, -c, -b, a)):
        curve[..., entry, 4] = curve[..., 4, entry] = other
    return plane * hoop, slope, curve


def _isochoric_moduli(f: np.ndarray) -> np.ndarray:
    """Second derivatives of (J^(-2/3) f.f - 3) / 2 by f, shape (..., 5, 5)."""
    ratio, cofactor, curve = _ratio(f)
    root = (ratio ** (-2.0 / 3.0))[..., None, None]
    ratio = ratio[..., None, None]
    square = (f * f).sum(axis=-1)[..., None, None]
    mixed = f[..., :, None] * cofactor[..., None, :]
    mixed = mixed + np.swapaxes(mixed, -1, -2)
    outer = cofactor[..., :, None] * cofactor[..., None, :]
    return root * (
        np.eye(5)
        - square * curve / (3.0 * ratio)
        - 2.0 * mixed / (3.0 * ratio)
        + 5.0 * square * outer / (9.0 * ratio**2)
    )
