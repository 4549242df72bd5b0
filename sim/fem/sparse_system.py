"""The free equations of a mesh: their numbering, one fixed sparsity pattern, and fast scatter.

Every stiffness that occurs (elements, springs and contact on faces of elements) lies in the pattern
of the elements, so it is built once and factorised symbolically once. The pattern is found by pairs
of nodes: each is a block of 3 x 3.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np


@dataclass(frozen=True, kw_only=True)
class System:
    """Numbering and pattern."""

    node_count: int
    free: np.ndarray
    """Degrees of freedom 3 node + axis that are free, shape (E,)."""
    numbers: np.ndarray
    """Number of each node among the free ones, -1 where it is held, shape (N,)."""
    pairs: np.ndarray
    """Sorted keys row F + column of the pairs of free nodes that meet, F free nodes, shape (B,)."""
    starts: np.ndarray
    """First pair of each free node, shape (F + 1,)."""
    indptr: np.ndarray
    """Rows of the pattern in CSR form, shape (E + 1,), int32."""
    indices: np.ndarray
    """Sorted columns, shape (Z,), int32."""

    def slots(self, nodes: np.ndarray) -> np.ndarray:
        """Where the stiffness of groups of nodes goes, (G, B) to (G, 3 B, 3 B); Z: nowhere."""
        groups, width = nodes.shape
        number = self.numbers[nodes]
        rows = np.broadcast_to(number[:, :, None], (groups, width, width))
        columns = np.broadcast_to(number[:, None, :], (groups, width, width))
        inside = (rows >= 0) & (columns >= 0)
        row = rows[inside]
        pair = np.searchsorted(self.pairs, row * np.int64(len(self.starts) - 1) + columns[inside])
        begin, length = self.starts[row], 3 * (self.starts[row + 1] - self.starts[row])
        first = 9 * begin + 3 * (pair - begin)
        axis = np.arange(3)
        block = first[:, None, None] + axis[:, None] * length[:, None, None] + axis
        found = np.full((groups, width, width, 3, 3), len(self.indices), dtype=np.int64)
        found[inside] = block
        return found.transpose(0, 1, 3, 2, 4).reshape(groups, 3 * width, 3 * width)

    def matrix(self, *parts: tuple[np.ndarray, np.ndarray]) -> Any:
        """Sum of (slots, values) as a CSR matrix of the free equations, shape (E, E)."""
        from scipy.sparse import csr_matrix

        size = len(self.indices)
        data = np.zeros(size)
        for slots, values in parts:
            if slots.size:
                data += np.bincount(slots.ravel(), values.ravel(), size + 1)[:size]
        shape = (len(self.free), len(self.free))
        return csr_matrix((data, self.indices, self.indptr), shape=shape)

    def gather(self, nodes: np.ndarray, values: np.ndarray) -> np.ndarray:
        """Sum of values of groups of nodes, (G, B) and (G, 3 B), at all nodes, shape (N, 3)."""
        size = 3 * self.node_count
        return np.bincount(freedoms_of(nodes).ravel(), values.ravel(), size).reshape(-1, 3)

    def reduced(self, field: np.ndarray) -> np.ndarray:
        """Free part of a nodal field (N, 3), shape (E,)."""
        return field.ravel()[self.free]

    def expanded(self, values: np.ndarray) -> np.ndarray:
        """Nodal field (N, 3) of free values (E,), zero elsewhere."""
        field = np.zeros(3 * self.node_count)
        field[self.free] = values
        return field.reshape(-1, 3)


def freedoms_of(nodes: np.ndarray) -> np.ndarray:
    """Degrees of freedom 3 node + axis of groups of nodes, (G, B) to (G, 3 B)."""
    groups, width = nodes.shape
    return (3 * nodes[:, :, None] + np.arange(3)).reshape(groups, 3 * width)


def make_system(
    node_count: int, cells: np.ndarray, held: np.ndarray, *, joined: np.ndarray | None = None
) -> System:
    """Pattern of the free equations.

    Args:
        node_count: Nodes, each with three degrees of freedom.
        cells: Node numbers of the elements, shape (M, 8).
        held: Nodes whose displacement is prescribed, shape (N,), bool.
        joined: Nodes that all meet each other besides, shape (B,).
    """
    free_nodes = np.flatnonzero(~held)
    count = len(free_nodes)
    numbers = np.full(node_count, -1, dtype=np.int64)
    numbers[free_nodes] = np.arange(count)
    number = numbers[cells]
    rows, columns = np.repeat(number, 8, axis=1), np.tile(number, (1, 8))
    inside = (rows >= 0) & (columns >= 0)
    pairs = np.unique(rows[inside] * np.int64(count) + columns[inside])
    if joined is not None:
        both = numbers[joined][numbers[joined] >= 0]
        pairs = np.union1d(pairs, (both[:, None] * np.int64(count) + both).ravel())
    row, column = np.divmod(pairs, max(count, 1))
    starts = np.append(0, np.cumsum(np.bincount(row, minlength=count)))
    lengths = 3 * np.diff(starts)
    # The three rows of a node have the same columns, so its blocks are laid out row by row.
    blocks = (3 * column[:, None] + np.arange(3)).reshape(-1)
    pieces = [blocks[3 * a : 3 * b] for a, b in itertools.pairwise(starts)]
    indices = np.concatenate([np.tile(piece, 3) for piece in pieces] or [np.zeros(0, np.int64)])
    return System(
        node_count=node_count,
        free=(3 * free_nodes[:, None] + np.arange(3)).reshape(-1),
        numbers=numbers,
        pairs=pairs,
        starts=starts,
        indptr=np.append(0, np.cumsum(np.repeat(lengths, 3))).astype(np.int32),
        indices=indices.astype(np.int32),
    )
