"""Cutting a body out of a membrane: the cells around the contact, held where they were cut.

Strains of a bonded wall die out within a few thicknesses of the contact, so 12 mm around it give
the force to .04 % and fields to 3e-3 mm; 9 mm are enough for totals only. A skin over air, and one
that is driven, takes part as a whole.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.contact.region.backing import SIDEWAYS, backed_faces, bonded_faces, foundation_N_mm3
from sim.contact.region.drives import UNDRIVEN, driven_faces
from sim.contact.region.materials import moduli_MPa_at
from sim.fem.body import Body, Faces, make_faces
from sim.fem.elements import make_elements
from workbench.core.base.errors import MeshingError
from workbench.core.design.design import Elastomer, Law
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh, VolumeMesh

SIDES = np.array(
    [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]
)
"""Corners of the six faces of a hexahedron, counter-clockwise from outside."""
MOST_NEAR = 0.5
"""Share of elements near the contact beyond which it does not pay to condense the others."""
SAME_MM = 1e-9
"""Skin vertices and nodes of the hexahedra are the same numbers."""


@dataclass(frozen=True, kw_only=True)
class Submodel:
    """A body, and where it belongs in the membrane."""

    body: Body
    nodes: np.ndarray
    """Number in the membrane's hexahedra of each node of the body, shape (N,)."""
    skin: np.ndarray
    """Vertex of the outer skin that each node of the body is, -1 for none, shape (N,)."""
    inner: np.ndarray
    """Vertex of the inner skin likewise, shape (N,)."""
    drive: np.ndarray
    """Actuation that moves each node of the body, -1 for none, shape (N,)."""
    drives: int
    """Actuations of the press."""
    cut: np.ndarray
    """Nodes held because the mesh goes on beyond them, shape (N,), bool."""
    radius_mm: float
    """Radius of the cut; inf for the whole membrane."""


def cut_out(
    mesh: MembraneMesh,
    material: Elastomer,
    press: Press,
    centre_mm: np.ndarray,
    radius_mm: float,
    *,
    near_mm: float = math.inf,
) -> Submodel:
    """The cells whose centre lies within a radius.

    Args:
        mesh: The membrane, with hexahedra.
        material: The elastomer and its inclusions.
        press: Its actuations drive regions.
        centre_mm: Middle of the contact, shape (3,).
        radius_mm: Radius, or inf.
        near_mm: Radius beyond which the tangent takes the wall as it is at rest; a membrane on gel,
            and one that takes part as a whole, bends too far for that.

    Raises:
        MeshingError: If the membrane has no hexahedra, or none lies there.
        DesignError: If a driven region does not exist.
    """
    hexes = hexahedra_of(mesh)
    points_mm = hexes.points_mm
    away_mm = np.linalg.norm(points_mm[hexes.cells].mean(axis=1) - centre_mm, axis=1)
    kept = away_mm < radius_mm
    if not kept.any():
        raise MeshingError(
            f"no hexahedron lies within {radius_mm:g} mm of the contact",
            hint="raise fem.radius_mm",
            at="fem.radius_mm",
        )
    chosen = np.flatnonzero(kept)[np.argsort(away_mm[kept] >= near_mm, kind="stable")]
    nodes = np.unique(hexes.cells[chosen])
    cells = np.searchsorted(nodes, hexes.cells[chosen])
    cut = np.isin(nodes, hexes.cells[~kept])
    outer, inner = _skin_vertices(mesh, points_mm[nodes])
    drive = _drives(mesh, press, outer, inner)
    bonded = _members(inner, np.unique(mesh.inner.faces[bonded_faces(mesh)]))
    free_base = ~cut & (drive < 0)
    held = cut | (drive >= 0) | (bonded & free_base)
    moduli = moduli_MPa_at(material, mesh.outer, points_mm[nodes][cells].mean(axis=1))
    local_mm = points_mm[nodes]
    faces = boundary(cells)
    faces = faces[(outer[faces] >= 0).all(axis=1) & ~held[faces].all(axis=1)]
    springs, stiffness = _gel(mesh, material, local_mm, boundary(cells), inner)
    rigid = math.isfinite(radius_mm) and not len(springs.nodes)
    near = int((away_mm[kept] < near_mm).sum())
    if not rigid or near > MOST_NEAR * len(cells):
        near = len(cells)
    body = Body(
        points_mm=local_mm,
        elements=make_elements(
            local_mm,
            cells,
            shear_MPa=moduli[:, 0],
            bulk_MPa=moduli[:, 1],
            linear=material.law is Law.LINEAR,
        ),
        near=near,
        faces=make_faces(local_mm, faces),
        held=held,
        driven=drive >= 0,
        springs=springs,
        spring_N_mm=stiffness,
        young_MPa=material.young_MPa,
    )
    return Submodel(
        body=body,
        nodes=nodes,
        skin=outer,
        inner=inner,
        drive=drive,
        drives=len(press.actuations),
        cut=cut,
        radius_mm=radius_mm,
    )


def hexahedra_of(mesh: MembraneMesh) -> VolumeMesh:
    """The hexahedra of a membrane.

    Raises:
        MeshingError: If it has none, with the mesher's reason.
    """
    if mesh.hexes is None:
        raise MeshingError(
            f"finite elements need hexahedra, and this membrane has none: {mesh.notice}",
            hint="use the forces of the contact solver (source mpm), or change the shape",
            at="fem",
        )
    return mesh.hexes


def boundary(cells: np.ndarray) -> np.ndarray:
    """Faces that belong to one cell only, shape (Q, 4), counter-clockwise from outside."""
    faces = cells[:, SIDES].reshape(-1, 4)
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    return faces[np.sort(first[count == 1])]


def _skin_vertices(mesh: MembraneMesh, points_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertex of the outer and of the inner skin at each node (N, 3), -1 where there is none."""
    from scipy.spatial import KDTree

    found = []
    for skin in (mesh.outer, mesh.inner):
        away, vertex = KDTree(skin.points_mm).query(points_mm, distance_upper_bound=SAME_MM)
        found.append(np.where(np.isfinite(away), vertex, -1))
    return found[0], found[1]


def _members(vertices: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    """Nodes whose skin vertex is one of the chosen, shape (N,), bool."""
    return (vertices >= 0) & np.isin(vertices, chosen)


def _drives(mesh: MembraneMesh, press: Press, outer: np.ndarray, inner: np.ndarray) -> np.ndarray:
    """Actuation that moves each node, -1 for none, shape (N,)."""
    found = np.full(len(outer), UNDRIVEN)
    if not press.actuations:
        return found
    for skin, vertices, drives in zip(
        (mesh.outer, mesh.inner), (outer, inner), driven_faces(mesh, press), strict=True
    ):
        for number in range(len(press.actuations)):
            found[_members(vertices, np.unique(skin.faces[drives == number]))] = number
    return found


def _gel(
    mesh: MembraneMesh,
    material: Elastomer,
    points_mm: np.ndarray,
    faces: np.ndarray,
    inner: np.ndarray,
) -> tuple[Faces, np.ndarray]:
    """Faces that rest on gel, and their stiffness: k along the normal, a third of it sideways."""
    backed = np.unique(mesh.inner.faces[backed_faces(mesh)])
    resting = faces[_members(inner, backed)[faces].all(axis=1)]
    unit = foundation_N_mm3(mesh, material)
    if unit == 0.0:
        resting = resting[:0]
    supported = make_faces(points_mm, resting)
    corners = points_mm[resting]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    pairs = normal[:, :, None] * normal[:, None, :]
    moduli = unit * (SIDEWAYS * np.eye(3) + (1.0 - SIDEWAYS) * pairs)
    spread = np.repeat(moduli[:, None], supported.areas_mm2.shape[1], axis=1)
    return supported, supported.stiffness(spread)
