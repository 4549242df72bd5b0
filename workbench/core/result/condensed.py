"""A skin condensed to its nodes: how each moves when another is pushed, and how it hardens."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, kw_only=True, slots=True)
class SkinColumns:
    """Displacement of a skin's nodes by forces on some of them."""

    nodes: np.ndarray
    """Nodes that are pushed, shape (T,), int32."""
    starts: np.ndarray
    """First neighbour of each, then how many there are: shape (T + 1,), int64."""
    neighbours: np.ndarray
    """Nodes that move, ascending for each pushed one, shape (Z,), int32."""
    blocks_mm_N: np.ndarray
    """Displacement of the neighbour (rows) by a unit force (columns), shape (Z, 3, 3), float32."""


@dataclass(frozen=True, kw_only=True, slots=True)
class CondensedSkin:
    """The outer skin of a membrane at rest, and its compliance near each node.

    Pairs farther apart than `reach_mm` do not move each other. Node i moves by

        u_i = sum_j C_ij f_j,    C_ij = C_ji^T.
    """

    points_mm: np.ndarray
    """Nodes at rest, shape (N, 3), float64."""
    normals: np.ndarray
    """Outward unit normals, shape (N, 3), float64."""
    wall_mm: np.ndarray
    """Thickness of the elastomer below each node, shape (N,), float64."""
    faces: np.ndarray
    """Triangles, shape (F, 3), int32."""
    reach_mm: float
    """Distance beyond which no node moves another."""
    compliance: SkinColumns
    """C by rows: `nodes` are all N of them."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Hardening:
    """How much stiffer the skin is than at rest, by its indentation over its wall, s.

    Forces along the skin's normal grow by `normal`, those across it, where they stick, by
    `tangential`; each holds a, b, c of (1 + a s + b s^2) (1 + c e), e the sharpness of the object:
    1 for an edge, 0 for a ball as blunt as the wall is thick.
    """

    normal: tuple[float, float, float] = (0.0, 0.0, 0.0)
    tangential: tuple[float, float, float] = (0.0, 0.0, 0.0)
    deepest: float = 0.5
    """Largest s that was seen in the presses it was fitted to; beyond it s counts as this."""
    errors: dict[str, float] | None = None
    """Largest error of the force of each press of the fit, by its object [1]."""
