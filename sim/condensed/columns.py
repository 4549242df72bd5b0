"""Columns of the compliance of a skin: unit forces on its nodes, by finite elements at rest.

Static condensation (Guyan 1965) of a piece of the wall to its outer nodes: of K u = f, with f on
these only, C = (K^-1) restricted to them. A tile's columns come from the piece around it, held
where it is cut off.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from sim.fem.body import Body
from sim.fem.elements import evaluate
from sim.fem.linear_solver import make_solver
from sim.fem.submodel import Part, cut_out
from workbench.core.design.design import Elastomer
from workbench.core.press.press import Press
from workbench.core.result.condensed import SkinColumns
from workbench.core.result.results import MembraneMesh

AT_ONCE = 96
"""Right-hand sides at once."""


def tile_columns(
    mesh: MembraneMesh, material: Elastomer, nodes: np.ndarray, reach_mm: float
) -> SkinColumns:
    """Columns of the nodes of a tile.

    Args:
        mesh: The membrane, with hexahedra; its outer vertices are the nodes.
        material: Moduli at rest.
        nodes: Pushed vertices of the outer skin, shape (T,).
        reach_mm: Vertices at most this far from a pushed one are kept.

    Raises:
        MeshingError: If the membrane has no hexahedra there.
        SolveError: If the linear solver fails.
    """
    points_mm = mesh.outer.points_mm
    middle_mm = 0.5 * (points_mm[nodes].min(axis=0) + points_mm[nodes].max(axis=0))
    spread_mm = float(np.linalg.norm(points_mm[nodes] - middle_mm, axis=1).max())
    part = Part(centre_mm=middle_mm, radius_mm=spread_mm + reach_mm)
    sub = cut_out(mesh, material, Press(target_mm=tuple(middle_mm.tolist())), part)
    body = sub.body
    skin = np.flatnonzero((sub.marks.outer >= 0) & ~body.held)
    vertices = sub.marks.outer[skin]
    pushed = skin[np.isin(vertices, nodes)]
    found = _moved_mm(body, skin, pushed)
    away_mm = np.linalg.norm(body.points_mm[pushed][:, None] - body.points_mm[skin][None], axis=2)
    by_node = {}
    for number, node in enumerate(sub.marks.outer[pushed]):
        near = np.flatnonzero(away_mm[number] <= reach_mm)
        near = near[np.argsort(vertices[near], kind="stable")]
        by_node[int(node)] = (vertices[near], found[number, near])
    none = (np.zeros(0, np.int32), np.zeros((0, 3, 3), np.float32))
    rows = [by_node.get(int(node), none) for node in nodes]
    return SkinColumns(
        nodes=nodes.astype(np.int32),
        starts=np.append(0, np.cumsum([len(row[0]) for row in rows])).astype(np.int64),
        neighbours=np.concatenate([row[0] for row in rows]).astype(np.int32),
        blocks_mm_N=np.concatenate([row[1] for row in rows]).astype(np.float32),
    )


def _moved_mm(body: Body, skin: np.ndarray, pushed: np.ndarray) -> np.ndarray:
    """Displacement of skin nodes (S,) by unit forces on pushed ones (T,), (T, S, 3, 3)."""
    state = evaluate(body.elements, np.zeros_like(body.points_mm), tangent=True)
    assert state.tangent_N_mm is not None
    stiffness: Any = body.system.matrix(
        (body.system.slots(body.elements.cells), state.tangent_N_mm),
        (body.system.slots(body.springs.nodes), body.spring_N_mm),
    )
    solver = make_solver(symmetric=True, positive=True)
    try:
        solver.factorise(stiffness)
        rows, columns = _equations(body, skin), _equations(body, pushed)
        found = np.empty((len(rows), len(columns)), dtype=np.float32)
        for begin in range(0, len(columns), AT_ONCE):
            some = columns[begin : begin + AT_ONCE]
            right_N = np.zeros((stiffness.shape[0], len(some)))
            right_N[some, np.arange(len(some))] = 1.0
            found[:, begin : begin + len(some)] = solver.solve_many(right_N)[rows]
    finally:
        solver.close()
    return found.reshape(len(skin), 3, len(pushed), 3).transpose(2, 0, 1, 3)


def _equations(body: Body, nodes: np.ndarray) -> np.ndarray:
    """Numbers of the free equations of nodes (T,), shape (3 T,)."""
    return (3 * body.system.numbers[nodes][:, None] + np.arange(3)).ravel()
