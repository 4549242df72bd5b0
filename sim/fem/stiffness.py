"""Stiffness of hexahedra with mean dilatation: the derivative of their nodal forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class Moduli:
    """What the stiffness of M elements depends on beside their deformation."""

    scale_Nmm: np.ndarray
    """c, shape (M, 8)."""
    square: np.ndarray
    """I1, shape (M, 8)."""
    pressure_MPa: np.ndarray
    """p, shape (M,)."""
    volumes_mm3: np.ndarray
    """w J, shape (M, 8)."""
    bulk_N_mm5: np.ndarray
    """K / V: slope of the pressure by the volume, shape (M,)."""


def stiffness(
    slopes: np.ndarray,
    deformation: np.ndarray,
    inverse: np.ndarray,
    moduli: Moduli,
    found: np.ndarray,
) -> None:
    """Stiffness into `found`, shape (M, 24, 24), rows (a, i) and columns (b, k).

    With h = F^-T, c = mu J^(-2/3) w and s = p J w, dP_iJ / dF_kL is c [d_ik d_JL - (2/3)(F_iJ h_kL
    + h_iJ F_kL) + (2/9) I1 h_iJ h_kL + (I1 / 3) h_iL h_kJ] + s (h_iJ h_kL - h_iL h_kJ). Between the
    slopes of the nodes every product becomes one of vectors over (a, i): m = F dN_a, g = h dN_a.
    To that comes (K / V) G G^T of the pressure, with the volume's slope G = sum_q w J g. All sums
    of products x y^T are one product of matrices.
    """
    count = len(slopes)
    by_point = slopes.transpose(0, 2, 1, 3)

    def vectors(matrix: np.ndarray) -> np.ndarray:
        return (by_point @ np.swapaxes(matrix, -1, -2)).reshape(count, 8, 24)

    scale, square = moduli.scale_Nmm, moduli.square
    closing = moduli.pressure_MPa[:, None] * moduli.volumes_mm3
    m, g = vectors(deformation), vectors(inverse)
    growth = moduli.volumes_mm3[:, None, :] @ g
    middle = (1.0 / 9.0) * square * scale + 0.5 * closing
    left = middle[..., None] * g - (2.0 / 3.0) * scale[..., None] * m
    first = np.concatenate([left, g, moduli.bulk_N_mm5[:, None, None] * growth], axis=1)
    np.matmul(np.swapaxes(first, 1, 2), np.concatenate([g, left, growth], axis=1), out=found)
    crossed = np.swapaxes((scale * square / 3.0 - closing)[..., None] * g, 1, 2) @ g
    # Its rows are (a, k) and its columns (b, i).
    blocks = found.reshape(count, 8, 3, 8, 3)
    blocks += crossed.reshape(count, 8, 3, 8, 3).transpose(0, 1, 4, 3, 2)
    spread = (slopes * scale[:, None, :, None]).reshape(count, 8, 24)
    nodes = spread @ np.swapaxes(slopes.reshape(count, 8, 24), 1, 2)
    for axis in range(3):
        found[:, axis::3, axis::3] += nodes
