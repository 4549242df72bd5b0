"""The active region as arrays: cells, nodes, slots, masses, surface points.

Cells within the region, a ball about the target, take part. Nodes that they share with material
left out are fixed. Positions are stored from the target, so that single precision resolves
nanometres.

Layouts: nodes are sorted by x, y, z, so the three z-neighbours of a cell's stencil row are
consecutive and `rows` holds only the first of each of the nine rows. Cell a owns 81 slots,
`slot_index(a, n, c)`; a node finds its slots through `node_slots`.

Fictitious masses make a time step of 1 stable: one point's stiffness has the largest eigenvalue
lambda against its own mass split by the weights, so mass = stiffness / lambda holds for every sum
of points, and a penalty spring k adds k / lambda, k in its stiffest direction
(element-by-element bound; Belytschko and others, Nonlinear Finite Elements, 2nd ed., 6.2). The
step is stable below 4.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.grid.lattice_keys import cells_of, keys_of, look_up
from sim.contact.grid.stencil import gradient_table, point_slopes, point_weights, weight_table
from sim.contact.region.materials import moduli_MPa_at
from sim.contact.region.quadrature import SurfacePoints
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

_STENCIL = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), axis=-1).reshape(27, 3)


@dataclass(frozen=True, kw_only=True, slots=True)
class Region:
    """The ball in which material takes part."""

    centre_mm: np.ndarray
    """Shape (3,)."""
    radius_mm: float


@dataclass(frozen=True, kw_only=True, slots=True)
class Readout:
    """How the displacement of a skin's V vertices follows from that of the nodes."""

    count: int
    """V."""
    vertices: np.ndarray
    """Vertices in active cells, shape (A,), int64; the others are at rest."""
    cells: np.ndarray
    """Their cells, shape (A,), int64."""
    nodes: np.ndarray
    """Their 27 nodes, shape (A, 27)."""
    weights: np.ndarray
    """Their 27 weights, shape (A, 27)."""
    local: np.ndarray
    """Their places in their cells, in cell edges from the centre, shape (A, 3)."""

    def gradient(self, nodal_mm: np.ndarray, grid_mm: float) -> np.ndarray:
        """Displacement gradient at the active vertices, shape (A, 3, 3)."""
        slopes = point_slopes(self.local) / grid_mm
        return np.einsum("anr,anc->arc", nodal_mm[self.nodes], slopes)

    def displacement_mm(self, nodal_mm: np.ndarray) -> np.ndarray:
        """Displacement of all vertices, shape (V, 3), float32, from that of nodes (N, 3)."""
        found = np.zeros((self.count, 3), np.float32)
        found[self.vertices] = np.einsum("an,anc->ac", self.weights, nodal_mm[self.nodes])
        return found


@dataclass(frozen=True, kw_only=True, slots=True)
class Domain:
    """Arrays of the active region. C cells, N nodes, P surface points, A active vertices."""

    grid_mm: float
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
    grid_mm = material_points.grid_mm
    skins = [mesh.outer, mesh.inner] if inner_moves else [mesh.outer]
    skin_cells = [np.round(skin.points_mm / grid_mm).astype(np.int64) for skin in skins]
    point_cells = np.round(surface_points.position_mm / grid_mm).astype(np.int64)
    cells, fractions, left_out = _choose_cells(
        material_points, np.concatenate([*skin_cells, point_cells]), region
    )
    node_keys, rows = _number_nodes(cells)
    cell_keys = keys_of(cells)
    cut = np.isin(node_keys, keys_of(left_out[:, None] + _STENCIL))
    node_mm = cells_of(node_keys) * grid_mm - region.centre_mm
    volumes_mm3 = np.maximum(fractions, LEAST_FRACTION) * grid_mm**3 / 8.0

    owner, found = look_up(cell_keys, keys_of(point_cells))
    order = np.flatnonzero(found)[np.argsort(owner[found], kind="stable")]
    points = surface_points.take(order)
    owners, starts = np.unique(owner[order], return_index=True)
    local = points.position_mm / grid_mm - point_cells[order]
    weights = point_weights(local)

    moduli_MPa = moduli_MPa_at(material, mesh.outer, cells * grid_mm)
    stiffness = _eigenvalues(moduli_MPa)[:, None] / grid_mm**2
    masses = _spread(volumes_mm3 @ weight_table() * (stiffness / EIGENVALUE), rows, len(node_keys))
    spring = weights * (points.stiffness_N_mm / EIGENVALUE)[:, None]
    masses += _spread(spring, rows[owner[order]], len(node_keys))

    readouts = [
        _readout(skin.points_mm / grid_mm, cells_of_skin, cell_keys, rows)
        for skin, cells_of_skin in zip(skins, skin_cells, strict=True)
    ]
    return Domain(
        grid_mm=grid_mm,
        target_mm=region.centre_mm,
        node_mm=node_mm,
        rows=rows,
        volumes_mm3=volumes_mm3,
        moduli_MPa=moduli_MPa,
        linear=material.law is Law.LINEAR,
        node_slots=_node_slots(rows, len(node_keys)),
        masses=masses,
        fixed=cut,
        points=points,
        point_local=local,
        owners=owners.astype(np.int32),
        owner_starts=np.append(starts, len(order)).astype(np.int32),
        outer=readouts[0],
        inner=readouts[1] if len(readouts) > 1 else None,
        particles=int(np.count_nonzero(fractions)),
    )


def _readout(
    place: np.ndarray, place_cells: np.ndarray, cell_keys: np.ndarray, rows: np.ndarray
) -> Readout:
    """Readout of vertices at `place` (V, 3), in cell edges, that lie in cells `place_cells`."""
    owner, inside = look_up(cell_keys, keys_of(place_cells))
    vertices = np.flatnonzero(inside)
    local = place[vertices] - place_cells[vertices]
    return Readout(
        count=len(place),
        vertices=vertices,
        cells=owner[vertices],
        nodes=stencil_nodes(rows[owner[vertices]]),
        weights=point_weights(local),
        local=local,
    )


def _choose_cells(
    material_points: MaterialPoints, skin_cells: np.ndarray, region: Region
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Active cells in order, their fractions, and material cells left out beside them."""
    grid_mm = material_points.grid_mm
    material = material_points.cells.astype(np.int64)

    def within(cells: np.ndarray, margin_mm: float = 0.0) -> np.ndarray:
        from_centre_mm = np.linalg.norm(cells * grid_mm - region.centre_mm, axis=1)
        return from_centre_mm < region.radius_mm + margin_mm

    active = within(material)
    if not active.any():
        raise DesignError(
            f"no material lies within {region.radius_mm:g} mm of the target",
            hint="raise contact.active_radius_mm or move press.target_mm",
            at="contact.active_radius_mm",
        )
    bare = np.unique(keys_of(skin_cells[within(skin_cells)]))
    bare = cells_of(bare[~np.isin(bare, keys_of(material))])
    cells = np.concatenate([material[active], bare])
    fractions = np.concatenate([material_points.fractions[active], np.zeros((len(bare), 8))])
    order = np.argsort(keys_of(cells), kind="stable")
    beside = ~active & within(material, 4.0 * grid_mm)
    return cells[order], fractions[order].astype(np.float64), material[beside]


def _number_nodes(cells: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Keys of all stencil nodes in order, and the first node of each row, shape (C, 9)."""
    keys = keys_of(cells[:, None] + _STENCIL)
    nodes, inverse = np.unique(keys.ravel(), return_inverse=True)
    return nodes, inverse.reshape(-1, 27)[:, ::3].astype(np.int32)


def _node_slots(rows: np.ndarray, node_count: int) -> np.ndarray:
    slots = np.full((node_count, 27), NO_SLOT, np.int32)
    place = np.broadcast_to(np.arange(27), (len(rows), 27))
    slots[stencil_nodes(rows), place] = slot_index(np.arange(len(rows))[:, None], place)
    return slots


def _spread(values: np.ndarray, rows: np.ndarray, node_count: int) -> np.ndarray:
    return np.bincount(stencil_nodes(rows).ravel(), values.ravel(), node_count)
