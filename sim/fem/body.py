"""A piece of membrane as finite elements: what is held, where it may touch, what it rests on.

Contact is looked at in 3 x 3 Gauss points of each outer face: at nodes the force of a shallow press
would be off by half.
"""

from __future__ import annotations

import functools
from dataclasses import dataclass

import numpy as np

from sim.fem.elements import Elements
from sim.fem.sparse_system import System, make_system

POINTS = 3
"""Gauss points along each edge of a face."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Faces:
    """Quadrilaterals of nodes with their Gauss points."""

    nodes: np.ndarray
    """Node numbers, shape (Q, 4), counter-clockwise from outside."""
    areas_mm2: np.ndarray
    """Undeformed area of each point, shape (Q, P)."""
    weights: np.ndarray
    """Weights of the nodes at the points, shape (Q, P, 4): where a corner hangs, the face moves
    with the corners of a larger one."""

    def places(self, field: np.ndarray) -> np.ndarray:
        """A nodal field (N, C) at the points, shape (Q P, C)."""
        found = self.weights @ field[self.nodes]
        return found.reshape(-1, field.shape[1])

    def take(self, rows: np.ndarray) -> Faces:
        """Some of the faces."""
        return Faces(
            nodes=self.nodes[rows], areas_mm2=self.areas_mm2[rows], weights=self.weights[rows]
        )

    def shares(self, values: np.ndarray) -> np.ndarray:
        """Integral of values at the points (Q, P) by node, shape (Q, 4)."""
        return np.einsum("qp,qpa->qa", values * self.areas_mm2, self.weights)

    def forces(self, traction: np.ndarray) -> np.ndarray:
        """Nodal forces of tractions (Q, P, 3), shape (Q, 12)."""
        weighted = traction * self.areas_mm2[..., None]
        return (np.swapaxes(self.weights, 1, 2) @ weighted).reshape(len(self.nodes), 12)

    def stiffness(self, moduli: np.ndarray) -> np.ndarray:
        """Stiffness of springs per area (Q, P, 3, 3) between the points and rest, (Q, 12, 12)."""
        count, points = self.areas_mm2.shape
        weighted = moduli.reshape(count, points, 9) * self.areas_mm2[..., None]
        products = (self.weights[..., :, None] * self.weights[..., None, :]).reshape(
            count, points, 16
        )
        blocks = (np.swapaxes(products, 1, 2) @ weighted).reshape(count, 4, 4, 3, 3)
        return blocks.transpose(0, 1, 3, 2, 4).reshape(count, 12, 12)


@functools.cache
def face_weights() -> np.ndarray:
    """Weights of a face's four nodes at its points, shape (P, 4)."""
    u, v, _ = _rule()
    return (
        np.stack([(1 - u) * (1 - v), (1 + u) * (1 - v), (1 + u) * (1 + v), (1 - u) * (1 + v)]).T / 4
    )


def _rule() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Places u, v in [-1, 1] and weights of the Gauss points of a square, each of shape (P,)."""
    line, weight = np.polynomial.legendre.leggauss(POINTS)
    u, v = (x.ravel() for x in np.meshgrid(line, line, indexing="ij"))
    return u, v, np.outer(weight, weight).ravel()


def make_faces(
    points_mm: np.ndarray,
    corners: np.ndarray,
    *,
    nodes: np.ndarray | None = None,
    ties: np.ndarray | None = None,
) -> Faces:
    """Faces of a mesh.

    Args:
        points_mm: Nodes, shape (N, 3).
        corners: Corners of the faces, shape (Q, 4), counter-clockwise from outside.
        nodes: Nodes that they move with, where those are others, shape (Q, 4).
        ties: Weights of these in the corners, shape (Q, 4, 4).
    """
    u, v, weight = _rule()
    by_u = np.stack([-(1 - v), 1 - v, 1 + v, -(1 + v)]).T / 4
    by_v = np.stack([-(1 - u), -(1 + u), 1 + u, 1 - u]).T / 4
    places = points_mm[corners]
    area = np.cross(by_u @ places, by_v @ places)
    whole = np.broadcast_to(face_weights(), (len(corners), POINTS**2, 4))
    return Faces(
        nodes=(corners if nodes is None else nodes).astype(np.int64),
        areas_mm2=np.linalg.norm(area, axis=2) * weight,
        weights=whole if ties is None else whole @ ties,
    )


@dataclass(frozen=True, kw_only=True)
class Body:
    """A mesh ready to be loaded."""

    points_mm: np.ndarray
    """Nodes at rest, shape (N, 3)."""
    elements: Elements
    near: int
    """So many elements, the first ones, may strain much; the tangent takes the others as they are
    at rest. All of them are solved for exactly: the tangent only says where to."""
    faces: Faces
    """Where the object may touch."""
    held: np.ndarray
    """Nodes whose displacement is prescribed, shape (N,), bool."""
    driven: np.ndarray
    """Those of them that an actuation moves, shape (N,), bool."""
    springs: Faces
    """Faces that rest on gel; none where the skin is bonded."""
    spring_N_mm: np.ndarray
    """Constant stiffness of those faces, shape (S, 12, 12)."""
    young_MPa: float
    """Young's modulus that the smallest force counted as a load is measured by."""

    @functools.cached_property
    def system(self) -> System:
        """Numbering of the free equations."""
        return make_system(len(self.points_mm), self.elements.cells, self.held)

    def spring_forces(self, displacement_mm: np.ndarray) -> tuple[np.ndarray, float]:
        """Forces of the gel on the nodes, (N, 3), and its energy [N mm]."""
        moved = displacement_mm[self.springs.nodes].reshape(-1, 12)
        force = -np.einsum("sij,sj->si", self.spring_N_mm, moved)
        energy = -0.5 * float(np.einsum("si,si->", force, moved))
        return self.system.gather(self.springs.nodes, force), energy
