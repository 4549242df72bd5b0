"""What the nodes of a body are: vertices of the skins, driven, cut off, held."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.region.backing import bonded_faces
from sim.contact.region.drives import UNDRIVEN, driven_faces
from sim.fem.division import Division
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh

NONE = -1
"""Vertex of a node that is none."""
SAME_MM = 1e-9
"""Skin vertices and nodes of the hexahedra are the same numbers."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Marks:
    """Of N nodes."""

    outer: np.ndarray
    """Vertex of the outer skin that each is, -1 for none, shape (N,)."""
    inner: np.ndarray
    """Vertex of the inner skin likewise, shape (N,)."""
    drive: np.ndarray
    """Actuation that moves each, -1 for none, shape (N,)."""
    cut: np.ndarray
    """Held because the mesh goes on beyond them, shape (N,), bool."""
    held: np.ndarray
    """Whose displacement is prescribed, shape (N,), bool."""

    def inherited(self, division: Division) -> Marks:
        """Of the nodes of a divided mesh. New ones are no vertices of the skins; the others they
        are where all nodes that they lie between are."""
        none = np.full(len(division.points_mm) - len(self.outer), NONE)
        return Marks(
            outer=np.append(self.outer, none),
            inner=np.append(self.inner, none),
            drive=division.inherited(self.drive, UNDRIVEN),
            cut=division.inherited(self.cut, 0) > 0,
            held=division.inherited(self.held, 0) > 0,
        )


def make_marks(mesh: MembraneMesh, press: Press, points_mm: np.ndarray, cut: np.ndarray) -> Marks:
    """Of some nodes (N, 3) of the membrane's hexahedra.

    Args:
        mesh: The membrane.
        press: Its actuations drive regions.
        points_mm: The nodes.
        cut: Those beyond which the mesh goes on, shape (N,), bool.

    Raises:
        DesignError: If a driven region does not exist.
    """
    outer, inner = _skin_vertices(mesh, points_mm)
    drive = _drives(mesh, press, outer, inner)
    bonded = _members(inner, np.unique(mesh.inner.faces[bonded_faces(mesh)]))
    held = cut | (drive >= 0) | (bonded & ~cut & (drive < 0))
    return Marks(outer=outer, inner=inner, drive=drive, cut=cut, held=held)


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
