"""Contact forces at skin vertices from the stresses that another program printed.

At rest the stresses of the elements around a free node answer what acts on it from outside:

    f_a = sum_q sigma_q grad_x N_a(q) w_q det(dx/dxi),

q the 2x2x2 Gauss points, x the displaced places, sigma the Cauchy stress (for Hooke's law rest
places and its stress). Source: Bonet and Wood, Nonlinear Continuum Mechanics for Finite Element
Analysis, 2008, eq. 9.15. The force of a mid-edge node goes half to each of its ends.
Left out: the incompatible modes of C3D8I, whose share in dx is of second order; what the sum then
lacks of the printed total is stated as the balance.
"""

from __future__ import annotations

import numpy as np

from sim.fem.decks.mesh import EDGES
from sim.fem.elements import CORNERS, GAUSS

STEP = 1e-6
"""Half a step of the differences that give slopes of quadratic functions to 1e-10."""
ORDER = np.array([0, 1, 3, 2, 4, 5, 7, 6])
"""Our Gauss point at each place of the programs' list, where x runs fastest, then y, then z."""


def shape_functions(places: np.ndarray, count: int) -> np.ndarray:
    """Values of the functions of 8 or 20 nodes at places (P, 3) of the parent cube, (P, count).

    Source: Zienkiewicz and Taylor, The Finite Element Method, serendipity bricks.
    """
    along = 1.0 + places[:, None, :] * CORNERS[None]
    product = along.prod(axis=2) / 8.0
    if count == len(CORNERS):
        return product
    corner = product * (along.sum(axis=2) - 5.0)
    middle = np.array([CORNERS[list(ends)].mean(axis=0) for ends in EDGES])
    free = np.abs(middle) < 0.5
    factors = np.where(
        free[None], 1.0 - places[:, None, :] ** 2, 1.0 + places[:, None, :] * middle[None]
    )
    return np.hstack([corner, factors.prod(axis=2) / 4.0])


def shape_slopes(count: int) -> np.ndarray:
    """Their slopes at the Gauss points in the programs' order, shape (8 points, count, 3)."""
    places = GAUSS[ORDER]
    found = [
        shape_functions(places + STEP * axis, count) - shape_functions(places - STEP * axis, count)
        for axis in np.eye(3)
    ]
    return np.stack(found, axis=2) / (2.0 * STEP)


def stress_forces(places_mm: np.ndarray, cells: np.ndarray, stress_MPa: np.ndarray) -> np.ndarray:
    """Forces on the nodes from outside [N], shape (N, 3).

    Args:
        places_mm: Places of the nodes that the stress belongs to, shape (N, 3).
        cells: Elements whose stress is known, shape (M, 8) or (M, 20).
        stress_MPa: Their stress at the Gauss points, symmetric, shape (M, 8, 3, 3).
    """
    slopes = shape_slopes(cells.shape[1])
    local = places_mm[cells]
    jacobian = np.einsum("mai,qaj->mqij", local, slopes)
    volume = np.linalg.det(jacobian)
    gradient = np.einsum("qaj,mqji->mqai", slopes, np.linalg.inv(jacobian))
    force = np.einsum("mq,mqij,mqaj->mai", volume, stress_MPa, gradient)
    flat = cells.ravel()
    count = len(places_mm)
    sums = [np.bincount(flat, force[..., k].ravel(), count) for k in range(3)]
    return np.column_stack(sums)
