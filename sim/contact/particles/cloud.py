"""Points of membrane and object for the published method (`particles`), and a grid around them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.contact.grid.stencil import point_offsets
from sim.contact.motion.approach import Approach
from sim.contact.particles import kernels
from workbench.core.result.results import MaterialPoints, MembraneMesh

SHELL_CELLS = 3.0
"""Depth of the object that is filled, in cells: points farther inside meet no node of the skin."""
HELD_CELLS = 0.5
"""Points this near the inner skin are held, in cells."""
ROOM_CELLS = 3
"""Empty cells around the points at rest."""
NEIGHBOURS = 8
"""Points that a skin vertex takes its displacement from."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Cloud:
    """Points of membrane and object in the sensor frame, before anything moves."""

    place_mm: np.ndarray
    """Points of the membrane [mm], shape (P, 3)."""
    fraction: np.ndarray
    """Filled fraction of each, shape (P,)."""
    kind: np.ndarray
    """SUPPORT, BORDER or FREE (`particle_kernels`), shape (P,)."""
    body_mm: np.ndarray
    """Points of the object in its own frame [mm], shape (B, 3)."""
    grid_mm: float
    low: np.ndarray
    """Lowest node of the grid, in cells, shape (3,)."""
    nodes: tuple[int, int, int]
    """Nodes of the grid on each axis."""


def make_cloud(
    mesh: MembraneMesh,
    points: MaterialPoints,
    approach: Approach,
    *,
    radius_mm: float,
) -> Cloud:
    """Points of the region and of the object's shell, and a grid that holds the region."""
    from scipy.spatial import KDTree

    grid_mm = points.grid_mm
    place_mm = ((points.cells[:, None] + point_offsets()) * grid_mm).reshape(-1, 3)
    fraction = points.fractions.reshape(-1).astype(np.float64)
    away_mm = np.linalg.norm(place_mm - approach.target_mm, axis=1)
    chosen = (fraction > 0.0) & (away_mm < radius_mm)
    place_mm, fraction, away_mm = place_mm[chosen], fraction[chosen], away_mm[chosen]
    kind = np.full(len(place_mm), kernels.FREE)
    kind[away_mm > radius_mm - grid_mm] = kernels.BORDER
    near_mm, _ = KDTree(mesh.inner.points_mm).query(place_mm)
    kind[near_mm < HELD_CELLS * grid_mm] = kernels.SUPPORT
    low = np.floor(place_mm.min(axis=0) / grid_mm).astype(int) - ROOM_CELLS
    high = np.ceil(place_mm.max(axis=0) / grid_mm).astype(int) + ROOM_CELLS
    nx, ny, nz = (high - low + 1).tolist()
    return Cloud(
        place_mm=place_mm,
        fraction=fraction,
        kind=kind,
        body_mm=_body_points(approach, grid_mm, low, high),
        grid_mm=grid_mm,
        low=low,
        nodes=(nx, ny, nz),
    )


def _body_points(
    approach: Approach, grid_mm: float, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Points at half a cell that fill the object's shell and stay on the grid, (B, 3)."""
    collider = approach.collider
    count = math.ceil(collider.reach_mm / (0.5 * grid_mm))
    line = (np.arange(-count, count) + 0.5) * 0.5 * grid_mm
    body = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)
    distance, _ = collider.distance(body)
    # A point stands for a quarter cell around it: its face, not its centre, touches.
    body = body[(distance < -0.25 * grid_mm) & (distance > -SHELL_CELLS * grid_mm)]
    stays = np.ones(len(body), bool)
    for progress in np.arange(approach.frame_count + 1.0):
        origin, rotation = approach.pose(float(progress))
        cells = (body @ rotation.T + origin) / grid_mm
        stays &= ((cells > low + 2.0) & (cells < high - 2.0)).all(axis=1)
    return body[stays]


class Readout:
    """Displacement of the outer skin's vertices from that of the points nearest at rest."""

    def __init__(self, mesh: MembraneMesh, cloud: Cloud) -> None:
        from scipy.spatial import KDTree

        self.vertex_mm = mesh.outer.points_mm
        self._rest_mm = cloud.place_mm
        apart_mm, self._nearest = KDTree(cloud.place_mm).query(self.vertex_mm, k=NEIGHBOURS)
        within = apart_mm < 1.5 * cloud.grid_mm
        weights = within / np.maximum(apart_mm, 1e-6)
        total = weights.sum(axis=1, keepdims=True)
        self._weights = np.divide(weights, total, out=np.zeros_like(weights), where=total > 0.0)

    def displacement_mm(self, place_mm: np.ndarray) -> np.ndarray:
        """Displacement of all vertices [mm], shape (V, 3); zero outside the region."""
        moved_mm = place_mm - self._rest_mm
        return np.einsum("vn,vnc->vc", self._weights, moved_mm[self._nearest])
