"""The elastomer: a compressible neo-Hookean or a linear elastic solid.

    W = C10 (J^(-2/3) tr(F^T F) - 3) + (J - 1)^2 / D1,    C10 = mu / 2,    D1 = 2 / K.

Source: SimTac, Supplementary (C10 = 0.025 MPa, D1 = 4.1379 / MPa for E = 0.145 MPa, nu = 0.45).
The first Piola-Kirchhoff stress is written in the displacement gradient H = F - I, because
F - F^-T and J - 1 cancel in single precision while H and the cofactors of H do not. Dropping all
products of H leaves Hooke's law, P = mu (H + H^T) + (K - 2 mu / 3) tr(H) I: the linear solid.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.design.design import Elastomer, Law

SMALLEST_VOLUME_RATIO = 1e-3
"""Floor of J inside J^(-2/3); only an inverted point, which a settled state has not, meets it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ElasticSolid:
    """Constants of the solid [MPa] and its law."""

    shear_MPa: float
    """mu = E / (2 (1 + nu))."""
    bulk_MPa: float
    """K = E / (3 (1 - 2 nu))."""
    linear: bool = False
    """Hooke's law instead of the neo-Hookean one."""

    @property
    def lame_MPa(self) -> float:
        """lambda = K - 2 mu / 3."""
        return self.bulk_MPa - 2.0 * self.shear_MPa / 3.0

    @property
    def c10_MPa(self) -> float:
        """First constant of W [MPa]."""
        return 0.5 * self.shear_MPa

    @property
    def d1_per_MPa(self) -> float:
        """Second constant of W [1/MPa]."""
        return 2.0 / self.bulk_MPa


def elastic_solid(material: Elastomer) -> ElasticSolid:
    """Constants of an elastomer from Young's modulus and Poisson's ratio."""
    shear_MPa, bulk_MPa = moduli_MPa(material.young_MPa, material.poisson)
    return ElasticSolid(shear_MPa=shear_MPa, bulk_MPa=bulk_MPa, linear=material.law is Law.LINEAR)


def moduli_MPa(young_MPa: float, poisson: float) -> tuple[float, float]:
    """Shear and bulk modulus [MPa]."""
    return young_MPa / (2.0 * (1.0 + poisson)), young_MPa / (3.0 * (1.0 - 2.0 * poisson))


def first_piola(gradient: np.ndarray, solid: ElasticSolid) -> np.ndarray:
    """First Piola-Kirchhoff stress [MPa] of displacement gradients.

    P = mu J^(-2/3) (F - tr(F^T F) / 3 F^-T) + K (J - 1) J F^-T.

    Args:
        gradient: H = du/dX, shape (..., 3, 3).
        solid: Constants.

    Returns:
        Stress, shape (..., 3, 3).
    """
    return stress_of(gradient, solid.shear_MPa, solid.bulk_MPa, linear=solid.linear)


def stress_of(
    gradient: np.ndarray,
    shear_MPa: np.ndarray | float,
    bulk_MPa: np.ndarray | float,
    *,
    linear: bool,
) -> np.ndarray:
    """`first_piola` with moduli that may differ from point to point, shape (...) or scalars."""
    rows = [[gradient[..., r, c] for c in range(3)] for r in range(3)]
    stress = first_piola_rows(
        rows,
        (shear_MPa, bulk_MPa),
        lambda ratio: np.maximum(ratio, SMALLEST_VOLUME_RATIO) ** (-1.0 / 3.0),
        linear=linear,
    )
    return np.stack([np.stack(row, axis=-1) for row in stress], axis=-2)


def energy_density_MPa(
    gradient: np.ndarray,
    shear_MPa: np.ndarray | float,
    bulk_MPa: np.ndarray | float,
    *,
    linear: bool,
) -> np.ndarray:
    """Strain energy per undeformed volume [MPa = N mm / mm3] of gradients (..., 3, 3).

    W as in the module's text; for the linear solid mu e:e + (K / 2 - mu / 3) tr(e)^2, e = sym H.
    """
    if linear:
        strain = 0.5 * (gradient + np.swapaxes(gradient, -1, -2))
        trace = np.trace(strain, axis1=-2, axis2=-1)
        square = np.einsum("...rc,...rc->...", strain, strain)
        return shear_MPa * square + (0.5 * bulk_MPa - shear_MPa / 3.0) * trace**2
    deformation = gradient + np.eye(3)
    ratio = np.maximum(np.linalg.det(deformation), SMALLEST_VOLUME_RATIO)
    square = np.einsum("...rc,...rc->...", deformation, deformation)
    isochoric = 0.5 * shear_MPa * (square * ratio ** (-2.0 / 3.0) - 3.0)
    return isochoric + 0.5 * bulk_MPa * (ratio - 1.0) ** 2


def first_piola_rows(
    gradient: list[list[Any]],
    moduli_MPa: tuple[Any, Any],
    inverse_cube_root: Callable[[Any], Any],
    *,
    keep: Callable[[Any], Any] = lambda expression: expression,
    linear: bool = False,
) -> list[list[Any]]:
    """The nine entries of the first Piola-Kirchhoff stress, in H = F - I.

    With the cofactors k of H, cof F = I + E, E = k - H^T + tr(H) I and
    J - 1 = tr(H) + tr(k) + det(H). Then, with s = mu J^(-2/3),
    P = s (H - E) + (s (3 (J - 1) - 2 tr(H) - H:H) / (3 J) + K (J - 1)) (I + E).

    Args:
        gradient: H by rows; numbers, arrays or Taichi expressions.
        moduli_MPa: mu and K.
        inverse_cube_root: J to J^(-1/3), with J kept above `SMALLEST_VOLUME_RATIO`.
        keep: Makes an expression a local variable (`stencil`).
        linear: Hooke's law: the same without products of H.
    """
    shear, bulk = moduli_MPa
    axes = range(3)
    if linear:
        trace = keep(gradient[0][0] + gradient[1][1] + gradient[2][2])
        pressure = keep((bulk - shear * (2.0 / 3.0)) * trace)
        return [
            [
                keep(shear * (gradient[r][c] + gradient[c][r]) + (pressure if r == c else 0.0))
                for c in axes
            ]
            for r in axes
        ]

    def minor(row: int, column: int) -> Any:
        r1, r2, c1, c2 = (row + 1) % 3, (row + 2) % 3, (column + 1) % 3, (column + 2) % 3
        return gradient[r1][c1] * gradient[r2][c2] - gradient[r1][c2] * gradient[r2][c1]

    cofactor = [[keep(minor(r, c)) for c in axes] for r in axes]
    trace = keep(gradient[0][0] + gradient[1][1] + gradient[2][2])
    determinant = sum((gradient[0][c] * cofactor[0][c] for c in axes), 0.0)
    dilation = keep(trace + (cofactor[0][0] + cofactor[1][1] + cofactor[2][2]) + determinant)
    square = keep(sum((gradient[r][c] * gradient[r][c] for r in axes for c in axes), 0.0))
    excess = [
        [keep(cofactor[r][c] - gradient[c][r] + (trace if r == c else 0.0)) for c in axes]
        for r in axes
    ]
    root = keep(inverse_cube_root(1.0 + dilation))
    scaled = keep(shear * root * root)
    isochoric = scaled * root * root * root * (3.0 * dilation - 2.0 * trace - square) * (1.0 / 3.0)
    pressure = keep(isochoric + bulk * dilation)
    return [
        [
            keep(
                scaled * (gradient[r][c] - excess[r][c])
                + pressure * (excess[r][c] + (1.0 if r == c else 0.0))
            )
            for c in axes
        ]
        for r in axes
    ]
