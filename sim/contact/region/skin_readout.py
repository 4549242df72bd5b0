"""How a skin moves with the nodes around it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import point_slopes, point_weights
from sim.contact.region.halving import Spot


@dataclass(frozen=True, kw_only=True, slots=True)
class Readout:
    """How the displacement of a skin's V vertices follows from that of the nodes."""

    count: int
    """V."""
    vertices: np.ndarray
    """Vertices in active cells, shape (A,), int64; the others are at rest."""
    cells: np.ndarray
    """Their cells, shape (A,), int64."""
    edges_mm: np.ndarray
    """Edges of those [mm], shape (A,)."""
    nodes: np.ndarray
    """Their 27 nodes, shape (A, 27)."""
    weights: np.ndarray
    """Their 27 weights, shape (A, 27)."""
    local: np.ndarray
    """Their places in their cells, in cell edges from the centre, shape (A, 3)."""

    def gradient(self, nodal_mm: np.ndarray) -> np.ndarray:
        """Displacement gradient at the active vertices, shape (A, 3, 3)."""
        slopes = point_slopes(self.local) / self.edges_mm[:, None, None]
        return np.einsum("anr,anc->arc", nodal_mm[self.nodes], slopes)

    def displacement_mm(self, nodal_mm: np.ndarray) -> np.ndarray:
        """Displacement of all vertices, shape (V, 3), float32, from that of nodes (N, 3)."""
        found = np.zeros((self.count, 3), np.float32)
        found[self.vertices] = np.einsum("an,anc->ac", self.weights, nodal_mm[self.nodes])
        return found


def readout_of(
    spot: Spot, owner: np.ndarray, inside: np.ndarray, *, nodes: np.ndarray, edges_mm: np.ndarray
) -> Readout:
    """Readout of the vertices at a spot.

    Args:
        spot: Where the V vertices lie.
        owner: Number of the cell of each, shape (V,).
        inside: Which of these are cells of the region, shape (V,), bool.
        nodes: The 27 nodes of all cells, shape (C, 27).
        edges_mm: Edges of all cells [mm], shape (C,).
    """
    vertices = np.flatnonzero(inside)
    cells, local = owner[vertices], spot.local[vertices]
    return Readout(
        count=len(inside),
        vertices=vertices,
        cells=cells,
        edges_mm=edges_mm[cells],
        nodes=nodes[cells],
        weights=point_weights(local),
        local=local,
    )
