"""Where points meet a soft object, in plain NumPy and double precision: reads a settled frame.

The twin of `meeting_functions`; forces and friction are in `reference`.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import point_slopes, point_weights
from sim.contact.objects.collider import Collider
from sim.contact.region.domain import stencil_nodes
from sim.contact.soft.body import SoftObject

NEWTON = 4
"""Iterations for the place in the undeformed object, as in the kernels."""
NOWHERE = -1
"""Cell of a place outside the object."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Meeting:
    """P points and the object."""

    place_mm: np.ndarray
    """Places in the undeformed object [mm], shape (P, 3)."""
    cell: np.ndarray
    """Cells of the object, or NOWHERE, shape (P,)."""
    deformation: np.ndarray
    """Deformation gradient of the object there, shape (P, 3, 3)."""
    distance_mm: np.ndarray
    """Signed distance of the undeformed object there [mm], shape (P,)."""
    gradient: np.ndarray
    """Its gradient, shape (P, 3)."""

    @property
    def met(self) -> np.ndarray:
        """Points inside the object, shape (P,), bool."""
        return (self.cell != NOWHERE) & (self.distance_mm < 0.0)

    @property
    def steep(self) -> np.ndarray:
        """F^-T grad phi: the gradient in the deformed object, shape (P, 3)."""
        return np.einsum("pji,pj->pi", np.linalg.inv(self.deformation), self.gradient)


def cells_at(soft: SoftObject, place_mm: np.ndarray) -> np.ndarray:
    """Cells of the object around places, (P, 3), NOWHERE outside, shape (P,)."""
    index = np.floor(place_mm / soft.domain.grid_mm + 0.5).astype(int) - soft.first_cell
    inside = ((index >= 0) & (index < soft.cell_map.shape)).all(axis=1)
    found = np.full(len(place_mm), NOWHERE)
    found[inside] = soft.cell_map[tuple(index[inside].T)]
    return found


def deformed(
    soft: SoftObject, nodal_mm: np.ndarray, place_mm: np.ndarray, cell: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Displacement [mm], (P, 3), and its gradient, (P, 3, 3), at places in cells of the object."""
    cells = place_mm / soft.domain.grid_mm
    local = cells - np.floor(cells + 0.5)
    nodal = nodal_mm[stencil_nodes(soft.domain.rows[cell])]
    slopes = point_slopes(local) / soft.domain.grid_mm
    moved = np.einsum("pn,pnc->pc", point_weights(local), nodal)
    return moved, np.einsum("pnr,pnc->prc", nodal, slopes)


def meet(
    soft: SoftObject,
    collider: Collider,
    nodal_mm: np.ndarray,
    points_mm: np.ndarray,
    pose: tuple[np.ndarray, np.ndarray],
) -> Meeting:
    """Where points, (P, 3), sensor frame, meet the object deformed by nodal_mm, (N, 3)."""
    origin, rotation = pose
    wanted = (points_mm - soft.origin_mm) @ soft.rotation
    place = (points_mm - origin) @ rotation
    distance, gradient = collider.distance(place)
    place = place - np.where(distance > 0.0, distance, 0.0)[:, None] * gradient
    cell = cells_at(soft, place)
    deformation = np.tile(np.eye(3), (len(place), 1, 1))
    for _ in range(NEWTON):
        known = np.flatnonzero(cell != NOWHERE)
        moved, slope = deformed(soft, nodal_mm, place[known], cell[known])
        deformation[known] = np.eye(3) + slope
        excess = place[known] + moved - wanted[known]
        place[known] -= np.linalg.solve(deformation[known], excess[:, :, None])[:, :, 0]
        cell[known] = cells_at(soft, place[known])
    distance, gradient = collider.distance(place)
    return Meeting(
        place_mm=place,
        cell=cell,
        deformation=deformation,
        distance_mm=distance,
        gradient=gradient,
    )
