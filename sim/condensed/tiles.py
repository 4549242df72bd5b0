"""How a skin is divided into tiles, whose columns of compliance are found together.

A tile holds the nodes of one cell of a grid in space: large enough that its margin, which every
tile pays for anew, is not most of the work, small enough that a first touch waits a second.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.surface import closest_point, vertex_normals
from workbench.core.base.errors import MeshingError
from workbench.core.result.results import MembraneMesh

TILE_MM = 4.0
"""Edge of a tile [mm]."""
REACH_WALLS = 2.5
"""Distance to which a push is felt, in walls. A bonded wall of nu .45 moves there by .6 % of what
it moves at the push."""
LEAST_REACH_MM = 4.0
"""The least such distance [mm]."""
NODE_MM, LEAST_NODE_MM = 0.6, 0.4
"""Largest and least distance of nodes [mm]."""
NODES_A_WALL = 3.3
"""Nodes through the wall: fewer are too stiff, more cost with the third power."""


def node_mm(wall_mm: float) -> float:
    """Distance of the nodes of the condensed skin on a wall of so much elastomer [mm]."""
    return float(np.clip(wall_mm / NODES_A_WALL, LEAST_NODE_MM, NODE_MM))


def reach_mm(wall_mm: float) -> float:
    """How far from a push nodes are looked at, on a wall of so much elastomer [mm]."""
    return max(LEAST_REACH_MM, REACH_WALLS * wall_mm)


def check_condensable(mesh: MembraneMesh) -> None:
    """Refuse membranes that fast contact does not know.

    Raises:
        MeshingError: If the skin is backed by air or gel, or has pins, or has no hexahedra.
    """
    at = "meshing"
    if len(mesh.tips_mm) or mesh.backing_mm > 0.0:
        raise MeshingError(
            "fast contact knows skins that are bonded to their support; this one has "
            + ("pins" if len(mesh.tips_mm) else f"a gap of {mesh.backing_mm:g} mm behind it"),
            hint="press it by the contact solver (`workbench run`)",
            at=at,
        )
    if mesh.hexes is None:
        raise MeshingError(
            f"fast contact needs hexahedra, and this membrane has none: {mesh.notice}",
            hint="press it by the contact solver (`workbench run`), or change the shape",
            at=at,
        )


def tiles(points_mm: np.ndarray) -> list[np.ndarray]:
    """Numbers of the nodes (N, 3) of each tile, ascending; together all, each once."""
    cells = np.floor(points_mm / TILE_MM).astype(np.int64)
    _, tile = np.unique(cells, axis=0, return_inverse=True)
    order = np.argsort(tile.ravel(), kind="stable")
    return np.split(order, np.flatnonzero(np.diff(tile.ravel()[order])) + 1)


def walls_mm(mesh: MembraneMesh) -> np.ndarray:
    """Elastomer between each vertex of the outer skin and the inner one [mm], shape (N,)."""
    _, away_mm, _ = closest_point(mesh.inner.points_mm, mesh.inner.faces, mesh.outer.points_mm)
    return away_mm


def skin_normals(mesh: MembraneMesh) -> np.ndarray:
    """Outward unit normals of the outer skin, shape (N, 3)."""
    return vertex_normals(mesh.outer.points_mm, mesh.outer.faces)
