"""The active region as arrays: cells, nodes, slots, masses, surface points.

Cells within the region, a ball about the target, take part. Nodes that they share with material
left out are fixed. Positions are stored from the target, so that single precision resolves
nanometres.

Cells may be halved, and halved again, where the contact is small (`halving`); the nodes of finer
cells at their border are tied to the coarser ones (`nodes`).

Layouts: nodes of a level are sorted by x, y, z, so the three z-neighbours of a cell's stencil row
are consecutive and `rows` holds only the first of each of the nine rows. Cell a owns 81 slots,
`slot_index(a, n, c)`; a node finds its slots through `node_slots`.

Fictitious masses make a time step of 1 stable: one point's stiffness has the largest eigenvalue
lambda against its own mass split by the weights, so mass = stiffness / lambda holds for every sum
of points, and a penalty spring k adds k / lambda, k in its stiffest direction
(element-by-element bound; Belytschko and others, Nonlinear Finite Elements, 2nd ed., 6.2). The
step is stable below 4. The mass of a tied node goes to its leaders by their shares, which sum to 1:
the lumped matrix bounds the condensed one.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import gradient_table, point_weights, weight_table
from sim.contact.region.halving import Halved, all_centres_mm, among, locate, owners_at, split
from sim.contact.region.materials import moduli_MPa_at
from sim.contact.region.nodes import STENCIL, Ties, number_nodes
from sim.contact.region.quadrature import SurfacePoints
from sim.contact.region.skin_readout import Readout, readout_of
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer, Law
from workbench.core.result.results import MaterialPoints, MembraneMesh

EIGENVALUE = 3.0
"""Largest eigenvalue aimed at; below 4 by a margin for stiffening under load."""
LEAST_FRACTION = 0.02
"""Filled fraction given to empty sub-cells of cut cells: without it fringe nodes drift to NaN."""
BLOCK = 32
"""Rows of a table that interleave, so that neighbouring threads reach neighbouring words."""
NO_SLOT = -1
"""Entry of `node_slots` where the lattice has no cell."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Region:
    """The ball in which material takes part, and where it is taken finely."""

    centre_mm: np.ndarray
    """Shape (3,)."""
    radius_mm: float
    halved: Halved = ()
    """Cells of each level that give way to finer ones, well within the region."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Domain:
    """Arrays of the active region. C cells, N nodes, P surface points, A active vertices."""

    grid_mm: float
    """Edge of a cell that is not halved."""
    edges_mm: np.ndarray
    """Edge of each cell [mm], shape (C,)."""
    target_mm: np.ndarray
    """Origin of all positions [mm], shape (3,)."""
    node_mm: np.ndarray
    """Node positions from the target [mm], shape (N, 3)."""
    rows: np.ndarray
    """First node of each of the nine z-rows of a cell, shape (C, 9), int32."""
    volumes_mm3: np.ndarray
    """Volume of the 8 points of a cell [mm3], shape (C, 8)."""
    moduli_MPa: np.ndarray
    """Shear and bulk modulus of a cell, shape (C, 2)."""
    linear: bool
    """Hooke's law instead of the neo-Hookean one."""
    node_slots: np.ndarray
    """First of the three slots that each of the 27 cells around a node keeps for it, by the node's
    place in the cell, or `NO_SLOT`; shape (N, 27), int32."""
    masses: np.ndarray
    """Fictitious masses [N/mm at unit time step], shape (N,)."""
    fixed: np.ndarray
    """Nodes shared with material that was left out, shape (N,), bool."""
    ties: Ties
    """Nodes of finer cells that follow those of coarser ones."""
    points: SurfacePoints
    """Surface points in the order of their cells."""
    point_local: np.ndarray
    """Places of the surface points in their cells, in cell edges from the centre, shape (P, 3)."""
    owners: np.ndarray
    """Cells that own surface points, shape (S,), int32."""
    owner_starts: np.ndarray
    """Where a cell's surface points start, shape (S + 1,), int32."""
    outer: Readout
    """Of the outer skin."""
    inner: Readout | None
    """Of the inner skin where it is free or driven, else None."""
    particles: int
    """Material points with volume before the floor."""


def stencil_nodes(rows: np.ndarray) -> np.ndarray:
    """The 27 nodes of each cell from its nine rows, (C, 9) to (C, 27)."""
    return (rows[:, :, None] + np.arange(3)).reshape(len(rows), 27)


def slot_index(cell: np.ndarray, node: np.ndarray | int, component: int = 0) -> np.ndarray:
    """Index of a slot among all slots (`cell_kernel.entry`)."""
    return (cell // BLOCK) * (81 * BLOCK) + (3 * node + component) * BLOCK + cell % BLOCK


def largest_point_eigenvalue(shear_MPa: float, bulk_MPa: float) -> float:
    """Largest eigenvalue [MPa] of a point's unit stiffness against its weights, unit cell edge.

    K_iajb = lambda B_ia B_jb + mu (B_ib B_ja + B_ic B_jc delta_ab) of the undeformed solid.
    """
    slopes, weights = gradient_table()[7], weight_table()[7]
    shear, lame = shear_MPa, bulk_MPa - 2.0 * shear_MPa / 3.0
    stiffness = lame * np.einsum("ia,jb->iajb", slopes, slopes)
    stiffness += shear * np.einsum("ib,ja->iajb", slopes, slopes)
    stiffness += shear * np.einsum("ic,jc,ab->iajb", slopes, slopes, np.eye(3))
    scale = 1.0 / np.sqrt(np.repeat(weights, 3))
    return float(np.linalg.eigvalsh(stiffness.reshape(81, 81) * np.outer(scale, scale))[-1])


def _eigenvalues(moduli_MPa: np.ndarray) -> np.ndarray:
    """`largest_point_eigenvalue` of each cell's moduli, (C, 2), shape (C,)."""
    kinds, which = np.unique(moduli_MPa, axis=0, return_inverse=True)
    return np.array([largest_point_eigenvalue(*kind) for kind in kinds])[which.ravel()]


def build_domain(
    mesh: MembraneMesh,
    material_points: MaterialPoints,
    surface_points: SurfacePoints,
    material: Elastomer,
    *,
    region: Region,
    inner_moves: bool,
) -> Domain:
    """Number the active region.

    Args:
        mesh: Its outer vertices receive displacements.
        material_points: Filled fractions of all cells.
        surface_points: Candidates; those in cells outside the region are dropped.
        material: Elastic constants of all parts.
        region: What takes part.
        inner_moves: Whether the inner skin is free or driven, and receives displacements too.

    Raises:
        DesignError: If no material lies in the region.
    """
    grid_mm, halved = material_points.grid_mm, region.halved
    skins = [mesh.outer, mesh.inner] if inner_moves else [mesh.outer]
    spots = [locate(skin.points_mm / grid_mm, halved) for skin in skins]
    at_points = locate(surface_points.position_mm / grid_mm, halved)
    cells, fractions, left_out = _choose_cells(material_points, region)
    touched = [
        np.concatenate([spot.cell[spot.level == level] for spot in (*spots, at_points)])
        for level in range(len(halved) + 1)
    ]
    touched[0] = touched[0][_within(touched[0] * grid_mm, region)]
    levels, fractions = split(
        cells, fractions, touched, halved=halved, grid_mm=grid_mm, outer=mesh.outer
    )
    numbered = number_nodes(levels, halved)
    rows, node_count = numbered.rows, sum(len(each) for each in numbered.places)
    edges_mm = np.concatenate([np.full(len(c), grid_mm * 0.5**n) for n, c in enumerate(levels)])
    near_left_out = among(numbered.places[0], left_out[:, None] + STENCIL)
    fixed = np.zeros(node_count, bool)
    fixed[: len(near_left_out)] = near_left_out
    volumes_mm3 = np.maximum(fractions, LEAST_FRACTION) * edges_mm[:, None] ** 3 / 8.0

    owner, found = owners_at(levels, at_points)
    order = np.flatnonzero(found)[np.argsort(owner[found], kind="stable")]
    points = surface_points.take(order)
    owners, starts = np.unique(owner[order], return_index=True)
    local = at_points.local[order]

    moduli_MPa = moduli_MPa_at(material, mesh.outer, all_centres_mm(levels, grid_mm))
    stiffness = (_eigenvalues(moduli_MPa) / edges_mm**2)[:, None]
    masses = _spread(volumes_mm3 @ weight_table() * (stiffness / EIGENVALUE), rows, node_count)
    spring = point_weights(local) * (points.stiffness_N_mm / EIGENVALUE)[:, None]
    masses += _spread(spring, rows[owner[order]], node_count)

    nodes = stencil_nodes(rows)
    readouts = [
        readout_of(spot, *owners_at(levels, spot), nodes=nodes, edges_mm=edges_mm) for spot in spots
    ]
    return Domain(
        grid_mm=grid_mm,
        edges_mm=edges_mm,
        target_mm=region.centre_mm,
        node_mm=all_centres_mm(numbered.places, grid_mm) - region.centre_mm,
        rows=rows,
        volumes_mm3=volumes_mm3,
        moduli_MPa=moduli_MPa,
        linear=material.law is Law.LINEAR,
        node_slots=_node_slots(rows, node_count),
        masses=numbered.ties.hand_on(masses),
        fixed=fixed,
        ties=numbered.ties,
        points=points,
        point_local=local,
        owners=owners.astype(np.int32),
        owner_starts=np.append(starts, len(order)).astype(np.int32),
        outer=readouts[0],
        inner=readouts[1] if len(readouts) > 1 else None,
        particles=int(np.count_nonzero(fractions)),
    )


def _choose_cells(
    material_points: MaterialPoints, region: Region
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Cells with material in the region, their fractions, and material cells left out beside."""
    grid_mm = material_points.grid_mm
    material = material_points.cells.astype(np.int64)
    active = _within(material * grid_mm, region)
    if not active.any():
        raise DesignError(
            f"no material lies within {region.radius_mm:g} mm of the target",
            hint="raise contact.active_radius_mm or move press.target_mm",
            at="contact.active_radius_mm",
        )
    beside = ~active & _within(material * grid_mm, region, margin_mm=4.0 * grid_mm)
    return material[active], material_points.fractions[active].astype(float), material[beside]


def _within(places_mm: np.ndarray, region: Region, *, margin_mm: float = 0.0) -> np.ndarray:
    from_centre_mm = np.linalg.norm(places_mm - region.centre_mm, axis=1)
    return from_centre_mm < region.radius_mm + margin_mm


def _node_slots(rows: np.ndarray, node_count: int) -> np.ndarray:
    slots = np.full((node_count, 27), NO_SLOT, np.int32)
    place = np.broadcast_to(np.arange(27), (len(rows), 27))
    slots[stencil_nodes(rows), place] = slot_index(np.arange(len(rows))[:, None], place)
    return slots


def _spread(values: np.ndarray, rows: np.ndarray, node_count: int) -> np.ndarray:
    return np.bincount(stencil_nodes(rows).ravel(), values.ravel(), node_count)
