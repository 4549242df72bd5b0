"""Cutting a body out of a membrane: the cells around the contact, held where they were cut.

Strains of a bonded wall die out within a few thicknesses of the contact, so 12 mm around it give
the force to .04 % and fields to 3e-3 mm; 9 mm are enough for totals only. A skin over air, and one
that is driven, takes part as a whole. Under the contact cells are divided (`division`, `grading`).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np

from sim.contact.region.backing import SIDEWAYS, backed_faces, foundation_N_mm3
from sim.contact.region.materials import moduli_MPa_at
from sim.fem.body import Body, Faces, make_faces
from sim.fem.division import (
    Division,
    Roots,
    Wanted,
    divide,
    nothing_finer,
    paired_roots,
)
from sim.fem.elements import make_elements
from sim.fem.grading import SmoothSkin
from sim.fem.marks import Marks, make_marks
from sim.fem.pieces import PLACES, SIDES
from workbench.core.base.errors import MeshingError
from workbench.core.design.design import Elastomer, Law
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh, VolumeMesh

MOST_NEAR = 0.8
"""Share of elements near the contact beyond which it does not pay to condense the others."""


@dataclass(frozen=True, kw_only=True)
class Part:
    """What part of a membrane is cut out, and how fine."""

    centre_mm: np.ndarray
    """Middle of the contact, shape (3,)."""
    radius_mm: float = math.inf
    """Cells whose middle is nearer take part; inf: all."""
    near_mm: float = math.inf
    """Radius beyond which the tangent takes the wall as it is at rest; a membrane on gel, and one
    that takes part as a whole, bends too far for that."""
    paired: bool = False
    """Whether eight cells of the mesh count as one that may be halved to them; the mesh must have
    such `groups`."""
    wanted: Wanted = nothing_finer
    """Which cells are halved."""
    halvings: int = 0
    """How often at most."""

    def coarser(self) -> Part:
        """The same with every cell halved once less."""
        wanted = self.wanted
        return replace(
            self,
            wanted=lambda level, middles_mm: wanted(level + 1, middles_mm),
            halvings=self.halvings - 1,
        )


@dataclass(frozen=True, kw_only=True)
class Submodel:
    """A body, and where it belongs in the membrane. Of its N nodes the first W are whole cells'."""

    body: Body
    nodes: np.ndarray
    """Number in the membrane's hexahedra of each of the first nodes, shape (W,)."""
    marks: Marks
    """What each node of the body is, shape (N,) each."""
    division: Division
    """How its cells were divided."""
    drives: int
    """Actuations of the press."""
    part: Part
    """What was cut out."""
    finest: int
    """How often the finest cells were halved."""

    def on_whole(self, values: np.ndarray) -> np.ndarray:
        """Sums at all nodes, (N,) or (N, C), on the first ones, (W,) or (W, C): each new node's
        goes to those it lies between."""
        return self.division.shares.T @ values


def cut_out(mesh: MembraneMesh, material: Elastomer, press: Press, part: Part) -> Submodel:
    """The cells whose middle lies within a radius, divided where they should be finer.

    Args:
        mesh: The membrane, with hexahedra.
        material: The elastomer and its inclusions.
        press: Its actuations drive regions.
        part: What is cut out.

    Raises:
        MeshingError: If the membrane has no hexahedra, or none lies there.
        DesignError: If a driven region does not exist.
    """
    hexes = hexahedra_of(mesh)
    cells = hexes.cells[hexes.groups, np.arange(8)] if part.paired else hexes.cells
    kept = _away_mm(hexes.points_mm, cells, part) < part.radius_mm
    if not kept.any():
        raise MeshingError(
            f"no hexahedron lies within {part.radius_mm:g} mm of the contact",
            hint="raise fem.radius_mm",
            at="fem.radius_mm",
        )
    members = hexes.groups[kept] if part.paired else np.flatnonzero(kept)[:, None]
    inside = np.zeros(len(hexes.cells), dtype=bool)
    inside[members] = True
    nodes = np.unique(hexes.cells[inside])
    roots = _roots(hexes, members, nodes)
    marks = make_marks(mesh, press, roots.points_mm, np.isin(nodes, hexes.cells[~inside]))
    outside = boundary_sides(roots.corners)
    corners = roots.corners[:, SIDES]
    touching = outside & (marks.outer[corners] >= 0).all(axis=2) & ~marks.held[corners].all(axis=2)
    division = divide(
        roots,
        part.wanted,
        most=part.halvings,
        placed=SmoothSkin(mesh.outer, marks.outer).middles,
    )
    away_mm = _away_mm(division.points_mm, division.corners, part)
    division = division.ordered(np.argsort(away_mm >= part.near_mm, kind="stable"))
    near = int((away_mm < part.near_mm).sum())
    springs, stiffness = _gel(
        mesh, material, division, outside & _rests(mesh, marks.inner[corners])
    )
    if not math.isfinite(part.radius_mm) or len(springs.nodes) or near > MOST_NEAR * len(away_mm):
        near = len(away_mm)
    marks = marks.inherited(division)
    middles_mm = division.points_mm[division.corners].mean(axis=1)
    moduli = moduli_MPa_at(material, mesh.outer, middles_mm)
    elements = make_elements(
        division.points_mm,
        division.corners,
        shear_MPa=moduli[:, 0],
        bulk_MPa=moduli[:, 1],
        linear=material.law is Law.LINEAR,
    )
    body = Body(
        points_mm=division.points_mm,
        elements=division.tied(elements),
        near=near,
        faces=_faces(division, touching),
        held=marks.held | division.hangs,
        driven=marks.drive >= 0,
        springs=springs,
        spring_N_mm=stiffness,
        young_MPa=material.young_MPa,
    )
    return Submodel(
        body=body,
        nodes=nodes,
        marks=marks,
        division=division,
        drives=len(press.actuations),
        part=part,
        finest=int(division.levels.max()),
    )


def _roots(hexes: VolumeMesh, members: np.ndarray, nodes: np.ndarray) -> Roots:
    """The coarsest cells: groups of eight, (R, 8), or single ones, (R, 1), with some nodes (W,)."""
    points_mm = hexes.points_mm[nodes]
    cells = np.searchsorted(nodes, hexes.cells[members.ravel()])
    if members.shape[1] == 1:
        return Roots(
            points_mm=points_mm, corners=cells, lattice=np.zeros((0, len(PLACES)), dtype=np.int64)
        )
    return paired_roots(points_mm, cells, np.arange(len(cells)).reshape(-1, 8))


def _away_mm(points_mm: np.ndarray, cells: np.ndarray, part: Part) -> np.ndarray:
    """Distance of the middles of cells (M, 8) from the contact's [mm], shape (M,)."""
    return np.linalg.norm(points_mm[cells].mean(axis=1) - part.centre_mm, axis=1)


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


def boundary_sides(cells: np.ndarray) -> np.ndarray:
    """Which of the `SIDES` of cells (M, 8) belong to one cell only, shape (M, 6), bool."""
    faces = np.sort(cells[:, SIDES].reshape(-1, 4), axis=1)
    _, first, count = np.unique(faces, axis=0, return_index=True, return_counts=True)
    found = np.zeros(len(faces), dtype=bool)
    found[first[count == 1]] = True
    return found.reshape(-1, 6)


def boundary(cells: np.ndarray) -> np.ndarray:
    """Faces that belong to one cell only, shape (Q, 4), counter-clockwise from outside."""
    return cells[:, SIDES][boundary_sides(cells)]


def _faces(division: Division, chosen: np.ndarray) -> Faces:
    """Pieces of the chosen sides, (cells before, 6), of the undivided mesh."""
    cell, side = np.nonzero(division.sides & chosen[division.roots])
    spots = SIDES[side]
    return make_faces(
        division.points_mm,
        np.take_along_axis(division.corners[cell], spots, axis=1),
        nodes=np.take_along_axis(division.cells[cell], spots, axis=1),
        ties=division.ties[cell[:, None, None], spots[:, :, None], spots[:, None, :]],
    )


def _rests(mesh: MembraneMesh, inner: np.ndarray) -> np.ndarray:
    """Which faces, of vertices (..., 4) of the inner skin, lie over a gap; shape (...), bool."""
    backed = np.unique(mesh.inner.faces[backed_faces(mesh)])
    return np.all((inner >= 0) & np.isin(inner, backed), axis=-1)


def _gel(
    mesh: MembraneMesh, material: Elastomer, division: Division, resting: np.ndarray
) -> tuple[Faces, np.ndarray]:
    """Faces that rest on gel, and their stiffness: k along the normal, a third of it sideways."""
    unit = foundation_N_mm3(mesh, material)
    if unit == 0.0:
        resting = np.zeros_like(resting)
    supported = _faces(division, resting)
    cell, side = np.nonzero(division.sides & resting[division.roots])
    corners = division.points_mm[np.take_along_axis(division.corners[cell], SIDES[side], axis=1)]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    pairs = normal[:, :, None] * normal[:, None, :]
    moduli = unit * (SIDEWAYS * np.eye(3) + (1.0 - SIDEWAYS) * pairs)
    spread = np.repeat(moduli[:, None], supported.areas_mm2.shape[1], axis=1)
    return supported, supported.stiffness(spread)
