"""How the skin that is drawn moves with the nodes of the condensed one.

Moving least squares with a quadratic basis in the tangent plane (Lancaster and Salkauskas 1981),
over the nearest nodes of the same side of the skin: a dent as round as a ball is drawn as deep as
it is, where a linear basis would blunt it.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

NEIGHBOURS = 14
"""Nodes that a vertex follows."""
WIDTH = 0.8
"""Standard deviation of their weights, in distances of nodes."""
SAME_SIDE = 0.3
"""Cosine between normals below which a node lies on another side."""
RIDGE = 1e-4
"""Added to the normal equations, for vertices at a rim that few nodes surround."""


@dataclass(frozen=True, kw_only=True)
class Surface:
    """Weights of nodes in V vertices."""

    nodes: np.ndarray
    """Shape (V, K), int32."""
    weights: np.ndarray
    """Of sum 1, shape (V, K), float32."""

    @functools.cached_property
    def _matrix(self) -> Any:
        """The weights as a sparse matrix of V rows."""
        from scipy.sparse import csr_array

        starts = np.arange(0, self.nodes.size + 1, self.nodes.shape[1])
        return csr_array((self.weights.ravel(), self.nodes.ravel(), starts))

    def displacement_mm(self, of_nodes_mm: np.ndarray) -> np.ndarray:
        """Displacement of the vertices, shape (B, V, 3), float32, from that of nodes (B, N, 3)."""
        known = self._matrix.shape[1]
        # Nodes beyond the last one that anything follows have no column.
        moved = [self._matrix @ one[:known] for one in of_nodes_mm]
        return np.stack(moved).astype(np.float32, copy=False)


def surface_of(
    nodes_mm: np.ndarray, node_normals: np.ndarray, vertices_mm: np.ndarray, normals: np.ndarray
) -> Surface:
    """Weights for vertices, (V, 3), with unit normals, from nodes, (N, 3), with theirs."""
    from scipy.spatial import KDTree

    tree = KDTree(nodes_mm)
    apart: Any = tree.query(nodes_mm, k=2)
    spacing_mm = float(np.median(apart[0][:, 1]))
    found: Any = tree.query(vertices_mm, k=min(NEIGHBOURS, len(nodes_mm)))
    away_mm, near = found
    offset = nodes_mm[near] - vertices_mm[:, None]
    facing = np.einsum("vki,vi->vk", node_normals[near], normals)
    weight = np.exp(-0.5 * (away_mm / (WIDTH * spacing_mm)) ** 2)
    weight *= (facing > SAME_SIDE) | (np.arange(near.shape[1]) == 0)
    first, second = _tangents(normals)
    a = np.einsum("vki,vi->vk", offset, first) / spacing_mm
    b = np.einsum("vki,vi->vk", offset, second) / spacing_mm
    basis = np.stack([np.ones_like(a), a, b, a * a, a * b, b * b], axis=2)
    weighted = basis * weight[:, :, None]
    normal_equations = np.einsum("vka,vkb->vab", weighted, basis)
    normal_equations[:, 1:, 1:] += RIDGE * np.eye(5)
    constant = np.zeros((len(vertices_mm), 6, 1))
    constant[:, 0] = 1.0
    share = np.linalg.solve(normal_equations, constant)[:, :, 0]
    weights = np.einsum("vka,va->vk", weighted, share)
    return Surface(nodes=near.astype(np.int32), weights=weights.astype(np.float32))


def _tangents(normals: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Two unit vectors across each normal, both (V, 3)."""
    across = np.zeros_like(normals)
    across[np.arange(len(normals)), np.abs(normals).argmin(axis=1)] = 1.0
    first = np.cross(normals, across)
    first /= np.linalg.norm(first, axis=1, keepdims=True)
    return first, np.cross(normals, first)
