"""Material points on a lattice: how much of every sub-cell a closed surface fills.

Sixteen vertical rays pass through each column of sub-cells. The filled length of a ray in a
sub-cell is exact: by the divergence theorem it is a sum over the ray's crossings z_h with the
surface, sum_h s_h clip(z_h - z_low, 0, height), where s_h = +1 leaving and -1 entering upward.
So nothing is sorted along a ray, and fractions err only between rays (O(spacing^2)).

Crossings come from scan conversion of the triangles instead of ray casting: on each row of rays a
triangle covers the interval between its long edge and one of its two short ones. Neighbours
compute their common edge from the same numbers in the same order, so every ray meets a closed
surface as often going in as going out, even through edges and corners.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.volume.pointlabels import point_regions
from workbench.core.base.monitor import Monitor, silent
from workbench.core.result.results import LabelledSurface, MaterialPoints

RAYS = 4
"""Rays across a sub-cell in x and in y."""
SLAB_CELLS = 16
"""Cells in y worked on at a time: bounds memory, and lets the user cancel."""
SMALLEST_FRACTION = 1e-4
"""Fractions below this are rounding, not material."""


class Frame(NamedTuple):
    """Extent of the lattice, in sub-cells: number s spans (s - 1) to s times `size_mm`."""

    size_mm: float
    low: np.ndarray
    """First sub-cell on each axis, even, shape (3,), int64."""
    count: np.ndarray
    """Sub-cells on each axis, even, shape (3,), int64."""


def material_points(
    surface: LabelledSurface, grid_mm: float, monitor: Monitor = silent
) -> MaterialPoints:
    """Fill a lattice with the inside of a closed surface.

    Args:
        surface: Watertight surface.
        grid_mm: Edge of a grid cell; each holds 2x2x2 points.
    """
    frame = _frame(surface.points_mm, grid_mm)
    triangles = _sorted_triangles(surface, frame)
    slabs = range(0, int(frame.count[1]), 2 * SLAB_CELLS)
    cells, fractions = [], []
    for number, first in enumerate(slabs):
        monitor(number / len(slabs), "filling the lattice")
        rows = min(2 * SLAB_CELLS, int(frame.count[1]) - first)
        filled = _fill(triangles, frame, first, rows)
        # Sub-cells of a cell side by side: (x, bx, y, by, z, bz) -> (x, y, z, bx, by, bz).
        nx, ny, nz = filled.shape
        blocks = filled.reshape(nx // 2, 2, ny // 2, 2, nz // 2, 2).transpose(0, 2, 4, 1, 3, 5)
        blocks = blocks.reshape(nx // 2, ny // 2, nz // 2, 8)
        taken = np.argwhere(blocks.any(axis=-1))
        fractions.append(blocks[tuple(taken.T)])
        cells.append(taken + (frame.low + np.array([0, first, 0])) // 2)
    unsorted = np.concatenate(cells)
    order = np.lexsort(unsorted.T[::-1])
    cell = unsorted[order].astype(np.int32)
    fraction = np.concatenate(fractions)[order].astype(np.float32)
    monitor(1.0, "marking regions")
    labels, numbers = point_regions(surface, cell, fraction, grid_mm)
    return MaterialPoints(
        grid_mm=grid_mm, cells=cell, fractions=fraction, labels=labels, numbers=numbers
    )


class _Triangles(NamedTuple):
    """Triangles with corners in order of y; x and y in ray spacings, z in sub-cells."""

    corners: np.ndarray
    """Shape (M, 3, 3)."""
    turn: np.ndarray
    """+1 where sorting kept the sense of rotation, else -1, shape (M,)."""


def _frame(points_mm: np.ndarray, grid_mm: float) -> Frame:
    size_mm = grid_mm / 2
    low = 2 * np.floor(points_mm.min(axis=0) / grid_mm + 0.5).astype(np.int64)
    high = 2 * np.floor(points_mm.max(axis=0) / grid_mm + 0.5).astype(np.int64) + 2
    return Frame(size_mm, low, high - low)


def _sorted_triangles(surface: LabelledSurface, frame: Frame) -> _Triangles:
    # Ray r of a frame lies at r + 1/2 ray spacings from its corner; shift so that it lies at r.
    unit = surface.points_mm / frame.size_mm - (frame.low - 1)
    unit[:, :2] = unit[:, :2] * RAYS - 0.5
    order = np.argsort(unit[surface.faces, 1], axis=1, kind="stable")
    even = (order[:, 1] - order[:, 0]) % 3 == 1
    corners = unit[np.take_along_axis(surface.faces, order, axis=1)]
    return _Triangles(corners, np.where(even, 1.0, -1.0))


def _fill(triangles: _Triangles, frame: Frame, first: int, rows: int) -> np.ndarray:
    """Filled fraction of the sub-cells in y rows first .. first + rows, shape (X, rows, Z)."""
    shape = int(frame.count[0]), rows, int(frame.count[2])
    column, row, height, sign = _crossings(triangles, first * RAYS, (first + rows) * RAYS)
    level = np.clip(np.floor(height).astype(np.int64), 0, shape[2] - 1)
    place = ((column // RAYS) * rows + row // RAYS) * shape[2] + level
    total = shape[0] * shape[1] * shape[2]
    partial = np.bincount(place, sign * (height - level), total).reshape(shape)
    crossed = np.bincount(place, sign, total).reshape(shape)
    above = np.cumsum(crossed[:, :, ::-1], axis=2)[:, :, ::-1] - crossed
    fraction = np.clip((partial + above) / RAYS**2, 0.0, 1.0)
    fraction[fraction < SMALLEST_FRACTION] = 0.0
    return fraction


def _crossings(
    triangles: _Triangles, first: int, stop: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Where rays in rows first .. stop - 1 cross the surface.

    Returns:
        Ray column; ray row counted from `first`; height in sub-cells; +1 where the ray leaves the
        body going up, -1 where it enters. All of shape (H,).
    """
    corners, turn = triangles
    bounds = np.clip(np.ceil(corners[:, :, 1]).astype(np.int64), first, stop)
    which, row = _ranges(bounds[:, 0], bounds[:, 2])
    corner = corners[which]
    upper = row >= bounds[which, 1]
    begin = np.where(upper[:, None], corner[:, 1], corner[:, 0])
    end = np.where(upper[:, None], corner[:, 2], corner[:, 1])
    x_long, z_long = _along(corner[:, 0], corner[:, 2], row)
    x_short, z_short = _along(begin, end, row)
    column_long, column_short = np.ceil(x_long), np.ceil(x_short)
    sign = np.where(column_long < column_short, 1.0, -1.0) * turn[which]
    left = np.minimum(column_long, column_short).astype(np.int64)
    right = np.maximum(column_long, column_short).astype(np.int64)
    span, column = _ranges(left, right)
    width = x_short[span] - x_long[span]
    share = np.clip((column - x_long[span]) / np.where(width == 0.0, 1.0, width), 0.0, 1.0)
    height = z_long[span] + share * (z_short[span] - z_long[span])
    return column, row[span] - first, height, sign[span]


def _ranges(start: np.ndarray, stop: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """All integers of many half-open ranges: the range each belongs to, and its value."""
    length = stop - start
    owner = np.repeat(np.arange(len(length)), length)
    offset = np.arange(len(owner)) - np.repeat(np.cumsum(length) - length, length)
    return owner, start[owner] + offset


def _along(low: np.ndarray, high: np.ndarray, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """x and z at height y = row on edges given from their lower to their upper end."""
    rise = high[:, 1] - low[:, 1]
    share = (row - low[:, 1]) / np.where(rise == 0.0, 1.0, rise)
    point = low + share[:, None] * (high - low)
    return point[:, 0], point[:, 2]
