"""Hexahedra divided in eight where they should be finer; hanging nodes follow their parents.

Cells that meet differ by one halving at most, at a face, an edge or a corner. A node in the middle
of an edge or a face of a coarser cell hangs: its displacement is the mean of that edge's or face's
corners. A cell that has such a corner takes the corner of its parent instead, so it still has eight
nodes and only its shape functions change:

    u(x) = sum_b N_b(x) u_b,   u_b = sum_a R_ba U_a,   dN'_a/dX = sum_b R_ba dN_b/dX.

Source: Burstedde, Wilcox and Ghattas (2011), section 3.2, for trilinear elements on forests of
octrees, here with any conforming mesh of hexahedra as roots.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from sim.fem.elements import Elements
from sim.fem.pieces import (
    CHILD_SPOTS,
    MEANS,
    PLACES,
    SIDES,
    belong_to,
    middle_nodes,
    new_lattice,
)

Wanted = Callable[[int, np.ndarray], np.ndarray]
"""Of a number of halvings and the middles of cells (M, 3): which should be halved again, (M,)."""
Placed = Callable[[np.ndarray, np.ndarray, Any], np.ndarray]
"""Of the corners (Q, 2) or (Q, 4) of edges or faces, all nodes (N, 3) and their weights of the
nodes before (N, N before): the middles, (Q, 3)."""


def nothing_finer(level: int, middles_mm: np.ndarray) -> np.ndarray:
    """No cell is wanted finer."""
    return np.zeros(len(middles_mm), dtype=bool)


def straight(corners: np.ndarray, points_mm: np.ndarray, shares: Any) -> np.ndarray:
    """Middles (Q, 3) of straight edges, (Q, 2), and faces, (Q, 4)."""
    return points_mm[corners].mean(axis=1)


@dataclass(frozen=True, kw_only=True)
class Roots:
    """The coarsest cells that there may be."""

    points_mm: np.ndarray
    """Nodes of a conforming mesh, shape (N, 3)."""
    corners: np.ndarray
    """Nodes of each cell, shape (R, 8), VTK order."""
    lattice: np.ndarray
    """Nodes of the eight cells that each is made of, in the order of `PLACES`, shape (R, 27);
    (0, 27) where the mesh has no finer cells."""


def paired_roots(points_mm: np.ndarray, cells: np.ndarray, groups: np.ndarray) -> Roots:
    """Each eight cells of a mesh as one.

    Args:
        points_mm: Nodes, shape (N, 3).
        cells: Hexahedra, shape (M, 8), VTK order.
        groups: Cells by the corner of the larger one that they have, shape (R, 8).
    """
    lattice = np.zeros((len(groups), len(PLACES)), dtype=np.int64)
    for child in range(8):
        lattice[:, CHILD_SPOTS[child]] = cells[groups[:, child]]
    return Roots(
        points_mm=points_mm,
        corners=np.take_along_axis(cells[groups], np.arange(8)[None, :, None], axis=2)[..., 0],
        lattice=lattice,
    )


@dataclass(frozen=True, kw_only=True)
class Division:
    """A divided mesh of M cells. Of its N nodes the first W are those it had before."""

    points_mm: np.ndarray
    """Nodes, hanging ones too, shape (N, 3)."""
    corners: np.ndarray
    """Corners of each cell, shape (M, 8)."""
    cells: np.ndarray
    """Nodes that each cell moves with, shape (M, 8): never hanging ones."""
    ties: np.ndarray
    """R of each cell: rows its corners, columns its nodes, shape (M, 8, 8)."""
    roots: np.ndarray
    """Root that each is a piece of, shape (M,)."""
    sides: np.ndarray
    """Which of its faces lie on the same face of its root, shape (M, 6), bool."""
    levels: np.ndarray
    """How often its root was halved, shape (M,)."""
    hangs: np.ndarray
    """Nodes that no cell moves with: they hang, or lie in an undivided root; shape (N,), bool."""
    shares: Any
    """Weights of the nodes before in each node, CSR, shape (N, W)."""
    born: tuple[tuple[np.ndarray, np.ndarray], ...]
    """Numbers of nodes, (B,), and of those in whose middle they lie, (B, C); coarse ones first."""

    def inherited(self, values: np.ndarray, otherwise: int) -> np.ndarray:
        """Whole numbers of the nodes before (W,), for all nodes: of a new one that of those it lies
        between if they agree, else `otherwise`."""
        found = np.full(len(self.points_mm), otherwise, dtype=np.int64)
        found[: len(values)] = values
        for nodes, between in self.born:
            of = found[between]
            new = (nodes >= len(values)) & (of == of[:, :1]).all(axis=1)
            found[nodes[new]] = of[new, 0]
        return found

    def followed(self, field: np.ndarray) -> np.ndarray:
        """A field (N, ...) of the nodes that cells move with, at the others too."""
        found = field.copy()
        for nodes, between in self.born:
            hanging = self.hangs[nodes]
            found[nodes[hanging]] = found[between[hanging]].mean(axis=1)
        return found

    def ordered(self, order: np.ndarray) -> Division:
        """The cells in another order, shape (M,)."""
        names = ("corners", "cells", "ties", "roots", "sides", "levels")
        return replace(self, **{name: getattr(self, name)[order] for name in names})

    def tied(self, elements: Elements) -> Elements:
        """Elements that were made of `corners`, moving with `cells`."""
        rows = np.flatnonzero((self.cells != self.corners).any(axis=1))
        slopes = elements.slopes.copy()
        slopes[rows] = np.einsum("mba,mbqi->maqi", self.ties[rows], slopes[rows])
        return replace(elements, cells=self.cells, slopes=slopes, owns=~self.hangs[self.corners])


@dataclass(kw_only=True)
class _Leaves:
    """Cells that are not divided (yet)."""

    corners: np.ndarray
    parents: np.ndarray
    """Corners of the cell that each is a piece of, shape (M, 8); its own where it is a root."""
    child: np.ndarray
    """Which corner of that cell it has, shape (M,)."""
    roots: np.ndarray
    sides: np.ndarray
    levels: np.ndarray

    def take(self, rows: np.ndarray) -> _Leaves:
        return _Leaves(**{name: value[rows] for name, value in vars(self).items()})

    def joined(self, other: _Leaves) -> _Leaves:
        mine, its = vars(self), vars(other)
        return _Leaves(**{name: np.concatenate([mine[name], its[name]]) for name in mine})


def divide(roots: Roots, wanted: Wanted, *, most: int, placed: Placed = straight) -> Division:
    """Divide the cells that are wanted finer, as far as their neighbours allow.

    Args:
        roots: The coarsest cells.
        wanted: Says what to halve; cells beside coarser ones stay as they are.
        most: Halvings at most.
        placed: Puts new nodes of edges and faces; hanging ones lie in the middle.
    """
    nodes = _Nodes(roots.points_mm, placed)
    count = len(roots.corners)
    leaves = _Leaves(
        corners=roots.corners,
        parents=roots.corners,
        child=np.zeros(count, dtype=np.int64),
        roots=np.arange(count),
        sides=np.ones((count, 6), dtype=bool),
        levels=np.zeros(count, dtype=np.int64),
    )
    for level in range(most):
        chosen = _choose(leaves, level, wanted, nodes)
        parents, left = leaves.take(chosen), leaves.take(~chosen)
        if level == 0 and len(roots.lattice):
            nodes.meet(roots.lattice, left.corners, chosen)
            lattice = roots.lattice[chosen]
        elif not chosen.any():
            break
        else:
            lattice = nodes.add(parents.corners, left.corners)
        leaves = left.joined(_children(parents, lattice, level + 1))
    cells, ties = _moving(leaves, nodes.hangs)
    return Division(
        points_mm=nodes.points_mm,
        corners=leaves.corners,
        cells=cells,
        ties=ties,
        roots=leaves.roots,
        sides=leaves.sides,
        levels=leaves.levels,
        hangs=nodes.hangs,
        shares=nodes.shares,
        born=tuple(nodes.born),
    )


class _Nodes:
    """Nodes while cells are being divided."""

    def __init__(self, points_mm: np.ndarray, placed: Placed) -> None:
        from scipy.sparse import csr_matrix

        count = len(points_mm)
        self.points_mm = points_mm.copy()
        self.hangs = np.zeros(count, dtype=bool)
        self.shares: Any = csr_matrix((np.ones(count), (np.arange(count), np.arange(count))))
        self.born: list[tuple[np.ndarray, np.ndarray]] = []
        self._placed = placed

    def meet(self, lattice: np.ndarray, coarse: np.ndarray, divided: np.ndarray) -> None:
        """Take nodes (R, 27) of roots that are there, some of them `divided`, (R,).

        Those of an edge or a face of an undivided cell (C, 8) hang, and are put in the middle.
        """
        used = np.zeros(len(self.points_mm), dtype=bool)
        used[lattice[divided]] = True
        for spots, between in middle_nodes(lattice):
            nodes, row = np.unique(spots, return_index=True)
            between = between[row]
            hanging = belong_to(between, coarse) | ~used[nodes]
            self.points_mm[nodes[hanging]] = self.points_mm[between[hanging]].mean(axis=1)
            self.hangs[nodes[hanging]] = True
            self.born.append((nodes, between))

    def add(self, parents: np.ndarray, coarse: np.ndarray) -> np.ndarray:
        """Divide cells (D, 8) beside undivided ones (C, 8); their lattice, shape (D, 27)."""
        from scipy.sparse import csr_matrix, vstack

        lattice, newly = new_lattice(parents, len(self.points_mm))
        for nodes, between in newly:
            hanging = belong_to(between, coarse)
            middles = straight(between, self.points_mm, self.shares)
            if between.shape[1] < 8:
                free = ~hanging
                middles[free] = self._placed(between[free], self.points_mm, self.shares)
            self.points_mm = np.concatenate([self.points_mm, middles])
            self.hangs = np.append(self.hangs, hanging)
            width = between.shape[1]
            rows = np.repeat(np.arange(len(nodes)), width)
            mean: Any = csr_matrix(
                (np.full(between.size, 1.0 / width), (rows, between.ravel())),
                shape=(len(nodes), self.shares.shape[0]),
            )
            self.shares = csr_matrix(vstack([self.shares, mean @ self.shares]))
            self.born.append((nodes, between))
        return lattice


def _choose(leaves: _Leaves, level: int, wanted: Wanted, nodes: _Nodes) -> np.ndarray:
    """Leaves to be halved, shape (M,), bool: none that touches a coarser one."""
    blocked = nodes.hangs.copy()
    blocked[leaves.corners[leaves.levels < level]] = True
    able = (leaves.levels == level) & ~blocked[leaves.corners].any(axis=1)
    rows = np.flatnonzero(able)
    able[rows] = wanted(level, nodes.points_mm[leaves.corners[rows]].mean(axis=1))
    return able


def _children(parents: _Leaves, lattice: np.ndarray, level: int) -> _Leaves:
    """The eight pieces of each of D cells."""
    pieces = []
    for child in range(8):
        on_side = np.array([child in side for side in SIDES])
        pieces.append(
            _Leaves(
                corners=lattice[:, CHILD_SPOTS[child]],
                parents=parents.corners,
                child=np.full(len(lattice), child),
                roots=parents.roots,
                sides=parents.sides & on_side,
                levels=np.full(len(lattice), level),
            )
        )
    found = pieces[0]
    for piece in pieces[1:]:
        found = found.joined(piece)
    return found


def _moving(leaves: _Leaves, hangs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes that each cell moves with, (M, 8), and its R, (M, 8, 8)."""
    hanging = hangs[leaves.corners]
    cells = np.where(hanging, leaves.parents, leaves.corners)
    ties = np.broadcast_to(np.eye(8), (len(cells), 8, 8)).copy()
    rows, corner = np.nonzero(hanging)
    ties[rows, corner] = MEANS[leaves.child[rows], corner]
    return cells, ties
