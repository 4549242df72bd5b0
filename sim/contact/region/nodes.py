"""Nodes of cells of several levels, and the ties that make the displacement one smooth field.

A quadratic B-spline is a sum of those of half its width: per axis, a node of the finer level has
3/4 of the node of the cell it is a child of, and 1/4 of the next one on its side. A finer node is
free where its whole support, three cells wide, lies in halved cells; any other is tied: it follows
the coarser nodes by these shares, and hands its force on to them by the same. Coarser nodes whose
whole support is halved do not exist. These are truncated hierarchical B-splines. Source: Giannelli,
Juettler and Speleers, CAGD 29, 2012.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from sim.contact.grid.lattice_keys import cells_of, keys_of, look_up
from sim.contact.region.halving import BITS, Halved, among, first_child, parents

STENCIL = np.stack(np.meshgrid(*[[-1, 0, 1]] * 3, indexing="ij"), axis=-1).reshape(27, 3)
NEAR, FAR = 0.75, 0.25
"""Shares of the two coarser nodes, per axis."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Ties:
    """Which nodes follow others: S tied nodes, each with its leaders and their shares."""

    nodes: np.ndarray
    """Tied nodes, shape (S,), int32."""
    starts: np.ndarray
    """Where the leaders of each start, shape (S + 1,), int32."""
    leaders: np.ndarray
    """Free nodes, int32; with `shares` one for each pair."""
    shares: np.ndarray
    """They sum to 1 for each tied node, float64."""

    @property
    def followers(self) -> np.ndarray:
        """The tied node of each pair."""
        return np.repeat(self.nodes, np.diff(self.starts))

    def lead(self, nodal: np.ndarray) -> np.ndarray:
        """Nodal values (N, ...), those of tied nodes as their leaders say."""
        found = nodal.copy()
        found[self.nodes] = 0.0
        shares = self.shares.reshape(-1, *[1] * (nodal.ndim - 1))
        np.add.at(found, self.followers, shares * nodal[self.leaders])
        return found

    def hand_on(self, nodal: np.ndarray) -> np.ndarray:
        """Nodal sums (N, ...), those of tied nodes added to their leaders' as well."""
        found = nodal.copy()
        shares = self.shares.reshape(-1, *[1] * (nodal.ndim - 1))
        np.add.at(found, self.leaders, shares * nodal[self.followers])
        return found


NO_TIES = Ties(
    nodes=np.zeros(0, np.int32),
    starts=np.zeros(1, np.int32),
    leaders=np.zeros(0, np.int32),
    shares=np.zeros(0),
)


@dataclass(frozen=True, kw_only=True, slots=True)
class Numbered:
    """Nodes of all cells: those of level 0 first, of each level in the order of x, y, z."""

    places: list[np.ndarray]
    """Lattice places of the nodes of each level, shape (n, 3)."""
    rows: np.ndarray
    """First node of each of the nine rows of each cell, shape (C, 9), int32."""
    ties: Ties


def number_nodes(cells: list[np.ndarray], halved: Halved) -> Numbered:
    """Number the nodes that cells of each level, (c, 3), need.

    Args:
        cells: Of each level.
        halved: Cells of each level but the last that gave way to the next.
    """
    wanted = np.zeros((0, 3), np.int64)
    keys: list[np.ndarray] = [np.zeros(0, np.int64)] * len(cells)
    for level in range(len(cells) - 1, -1, -1):
        stencil = (cells[level][:, None] + STENCIL).reshape(-1, 3)
        keys[level] = np.unique(keys_of(np.concatenate([stencil, wanted])))
        if level:
            places = cells_of(keys[level])
            wanted = _leaders(places[_tied(places, level, halved)], level)[0].reshape(-1, 3)
    starts = np.cumsum([0, *(len(each) for each in keys)])
    rows = [
        start + look_up(known, keys_of(own[:, None] + STENCIL[::3]))[0]
        for own, known, start in zip(cells, keys, starts, strict=False)
    ]
    places = [cells_of(each) for each in keys]
    return Numbered(
        places=places,
        rows=np.concatenate(rows).astype(np.int32),
        ties=_ties(places, keys, starts, halved) if len(cells) > 1 else NO_TIES,
    )


def _tied(places: np.ndarray, level: int, halved: Halved) -> np.ndarray:
    """Which nodes of a level reach beyond the halved cells of the level before, (n,), bool."""
    around = parents(places[:, None] + STENCIL, level)
    return np.logical_not(among(around, halved[level - 1]).all(axis=1))


def _leaders(places: np.ndarray, level: int) -> tuple[np.ndarray, np.ndarray]:
    """The eight nodes of the level before that nodes follow, (n, 8, 3), and shares, (n, 8)."""
    near = parents(places, level)
    side = 2 * (places - first_child(near, level - 1)) - 1
    found = near[:, None] + BITS * side[:, None]
    shares = np.where(BITS == 1, FAR, NEAR).prod(axis=1)
    return found, np.broadcast_to(shares, (len(places), 8))


def _ties(
    places: list[np.ndarray], keys: list[np.ndarray], starts: np.ndarray, halved: Halved
) -> Ties:
    """Ties to free nodes; where a leader is itself tied, to its leaders."""
    from scipy.sparse import csr_matrix, diags

    count = int(starts[-1])
    free = np.ones(count)
    followers, leaders, shares = [], [], []
    for level in range(1, len(places)):
        tied = np.flatnonzero(_tied(places[level], level, halved))
        led, share = _leaders(places[level][tied], level)
        number, _ = look_up(keys[level - 1], keys_of(led))
        followers.append(np.repeat(starts[level] + tied, 8))
        leaders.append((starts[level - 1] + number).ravel())
        shares.append(share.ravel())
        free[starts[level] + tied] = 0.0
    pairs = np.concatenate(followers), np.concatenate(leaders)
    step: Any = csr_matrix((np.concatenate(shares), pairs), (count, count)) + diags(free)
    whole: Any = step
    for _ in range(len(places) - 2):
        whole = step @ whole
    chosen = np.flatnonzero(free == 0.0)
    table = whole.tocsr()[chosen]
    table.eliminate_zeros()
    table.sort_indices()
    return Ties(
        nodes=chosen.astype(np.int32),
        starts=table.indptr.astype(np.int32),
        leaders=table.indices.astype(np.int32),
        shares=table.data,
    )
