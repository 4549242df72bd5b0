"""A structured grid of rays that covers a cap: a square patch on top, columns down its sides.

The top patch is one face of a cube blown up to a sphere with equal angles (the equiangular
cubed sphere); each of its border points continues down to the base as a column, so four points
have three neighbours and all others four. Rays start on the axis: from one centre for the cap,
horizontally below it.

Spacing follows the surface, not the angle: the mean meridian's arc length sets the polar spacing
(an ellipsoid's tip is as fine as its side), the perimeter sets the azimuths (an oval is even).
Leaves out: surfaces that the rays meet twice (suckers, pins).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from geometry.volume.curved import CurvedSurface

LIFT_MM = 1e-4
"""Height at which the base ring is cast [mm]: on z = 0 itself a ray runs along the rim."""
MERIDIANS = 16
SAMPLES = 200
AZIMUTHS = 720
LOWEST_CAP = 0.3
"""Smallest height of the cap's centre over the height of the surface."""
FEWEST = 4
"""Cells along a side of the top patch, at least."""
NO_GROUPS = np.zeros((0, 4), dtype=np.int32)


@dataclass(frozen=True, slots=True)
class Pace:
    """How cells are counted off along a line."""

    edge_mm: float
    """Edge of a cell."""
    paired: bool = False
    """Whether every line has an even number of cells, so that eight cells make a larger one."""

    def count(self, length_mm: float, fewest: int = 1) -> int:
        """Cells along a length, at least `fewest`."""
        if self.paired:
            return 2 * max(math.ceil(fewest / 2), round(length_mm / self.edge_mm / 2.0))
        return max(fewest, round(length_mm / self.edge_mm))


@dataclass(frozen=True, kw_only=True, slots=True)
class Axis:
    """The line on which rays start."""

    x_mm: float
    y_mm: float
    cap_mm: float
    """Height of the centre of the spherical part [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RayGrid:
    """Rays in a grid of quadrilaterals."""

    origins: np.ndarray
    """Starts [mm], shape (N, 3)."""
    directions: np.ndarray
    """Unit directions, shape (N, 3)."""
    quads: np.ndarray
    """Rays of each cell, counter-clockwise from outside, shape (Q, 4), int32."""
    ring: np.ndarray
    """Rays on the base, in order of azimuth, shape (4n,), int32."""
    groups: np.ndarray
    """Four cells that make a larger one, by the corner of it that each has, shape (G, 4); none
    where cells are not paired."""


def axis_of(points_mm: np.ndarray) -> Axis:
    """Axis through the middle of a surface whose base is z = 0; points (N, 3) [mm]."""
    low, high = points_mm.min(axis=0), points_mm.max(axis=0)
    x_mm, y_mm = (low[:2] + high[:2]) / 2
    half_width = float((high[:2] - low[:2]).min()) / 2
    cap_mm = max(float(high[2]) - half_width, LOWEST_CAP * float(high[2]))
    return Axis(x_mm=float(x_mm), y_mm=float(y_mm), cap_mm=cap_mm)


def ray_grid(surface: CurvedSurface, axis: Axis, pace: Pace) -> RayGrid:
    """Rays that divide a surface into cells of about `pace.edge_mm`.

    Raises:
        MeshingError: If a ray misses the surface.
    """
    azimuth_of, perimeter = _azimuth_pace(surface, axis)
    station_of, cap_arc, whole_arc = _meridian_pace(surface, axis)
    count = pace.count(perimeter / 4.0, FEWEST)
    angle = np.linspace(-np.pi / 4, np.pi / 4, count + 1)
    u, v = (np.tan(grid).ravel() for grid in np.meshgrid(angle, angle, indexing="ij"))
    top_arc = np.arctan(np.hypot(u, v)) / (np.pi / 2) * cap_arc
    top_turn = np.arctan2(v, u) % (2 * np.pi)

    index = np.arange((count + 1) ** 2, dtype=np.int32).reshape(count + 1, count + 1)
    border = patch_border(index)
    rows = pace.count(whole_arc - float(top_arc[border].mean()), 2)
    share = np.linspace(0.0, 1.0, rows + 1)[1:, None]
    side_arc = (1.0 - share) * top_arc[border] + share * whole_arc
    side_turn = np.broadcast_to(top_turn[border], side_arc.shape)
    station = station_of(np.concatenate([top_arc, side_arc.ravel()]))
    azimuth = azimuth_of(np.concatenate([top_turn, side_turn.ravel()]))
    origins, directions = _rays(axis, station, azimuth)
    side = len(top_arc) + np.arange(rows * len(border), dtype=np.int32).reshape(rows, -1)
    return RayGrid(
        origins=origins,
        directions=directions,
        quads=o_quads(index, np.vstack([border[None], side])),
        ring=side[-1],
        groups=o_groups(count, count, rows) if pace.paired else NO_GROUPS,
    )


def patch_border(index: np.ndarray) -> np.ndarray:
    """Nodes around a patch of node numbers (n+1, m+1), counter-clockwise from above.

    The first is at the end of the first axis and the start of the second.
    """
    return np.concatenate(
        [index[-1, :-1], index[::-1, -1][:-1], index[0, ::-1][:-1], index[:, 0][:-1]]
    )


def on_base(points_mm: np.ndarray, grid: RayGrid) -> np.ndarray:
    """The points, with those of the base ring put on z = 0; changed in place."""
    points_mm[grid.ring, 2] = 0.0
    return points_mm


def o_quads(top: np.ndarray, side: np.ndarray) -> np.ndarray:
    """Cells of the top patch (node numbers (n+1, m+1)) and of the rows around it (rows, 2(n+m)).

    Row 0 of `side` is the patch's own border.
    """
    patch = np.stack([top[:-1, :-1], top[1:, :-1], top[1:, 1:], top[:-1, 1:]], axis=-1)
    beside = np.roll(side, -1, axis=1)
    wall = np.stack([side[:-1], side[1:], beside[1:], beside[:-1]], axis=-1)
    return np.concatenate([patch.reshape(-1, 4), wall.reshape(-1, 4)]).astype(np.int32)


def o_groups(across: int, up: int, rows: int) -> np.ndarray:
    """Fours of the cells of `o_quads`, by corner, shape (G, 4); all counts are even."""
    patch = np.arange(across * up).reshape(across, up)
    wall = across * up + np.arange(rows * 2 * (across + up)).reshape(rows, -1)
    fours = [
        np.stack([n[::2, ::2], n[1::2, ::2], n[1::2, 1::2], n[::2, 1::2]], axis=-1).reshape(-1, 4)
        for n in (patch, wall)
    ]
    return np.concatenate(fours).astype(np.int32)


def _rays(axis: Axis, station: np.ndarray, azimuth: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rays of stations along the meridian: 0 the apex, 1 the cap's rim, 2 the base."""
    polar = np.minimum(station, 1.0) * np.pi / 2
    height = np.maximum(axis.cap_mm * np.minimum(1.0, 2.0 - station), LIFT_MM)
    origins = np.column_stack(
        [np.full(len(station), axis.x_mm), np.full(len(station), axis.y_mm), height]
    )
    flat = np.sin(polar)
    directions = np.column_stack([flat * np.cos(azimuth), flat * np.sin(azimuth), np.cos(polar)])
    return origins, directions


def _meridian_pace(surface: CurvedSurface, axis: Axis):
    """Map of arc length from the apex [mm] to station, and the arcs of cap and whole meridian."""
    station = np.linspace(0.0, 2.0, 2 * SAMPLES + 1)
    azimuth = 2 * np.pi * (np.arange(MERIDIANS) + 0.37) / MERIDIANS
    origins, directions = _rays(axis, np.tile(station, MERIDIANS), np.repeat(azimuth, len(station)))
    points = surface.points(origins, directions).reshape(MERIDIANS, len(station), 3)
    steps = np.linalg.norm(np.diff(points, axis=1), axis=2).mean(axis=0)
    arc = np.concatenate([[0.0], np.cumsum(steps)])

    def station_of(length_mm: np.ndarray) -> np.ndarray:
        return np.interp(length_mm, arc, station)

    return station_of, float(arc[SAMPLES]), float(arc[-1])


def _azimuth_pace(surface: CurvedSurface, axis: Axis):
    """Map of evenly spaced turn [rad] to azimuth, and the perimeter [mm] at half the cap's height.

    The turn 0 stays at azimuth 0, so that the grid has the planes of symmetry of an oval.
    """
    azimuth = np.linspace(0.0, 2 * np.pi, AZIMUTHS + 1)
    origins, directions = _rays(axis, np.full(len(azimuth), 1.5), azimuth)
    points = surface.points(origins, directions)
    steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
    arc = np.concatenate([[0.0], np.cumsum(steps)])
    turn = arc / arc[-1] * 2 * np.pi

    def azimuth_of(even: np.ndarray) -> np.ndarray:
        return np.interp(even, turn, azimuth)

    return azimuth_of, float(arc[-1])
