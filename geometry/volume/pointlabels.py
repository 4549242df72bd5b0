"""Regions of material points: which of them lie next to a labelled face, or inside a pin.

A point carries the label of every face that passes through its sub-cell or through one of the six
sub-cells beside it: all faces nearer than half a grid cell along an axis. A pin is thicker than
that, so all points inside the convex hull of its faces are its own. A point between two numbered
regions takes the higher number.

Faces are found by samples no more than 0.7 sub-cells apart, laid in rows along each triangle's
longest edge, so that slivers cost by their area and not by the square of their length.
"""

from __future__ import annotations

import numpy as np

from workbench.core.result.results import NO_NUMBER, Label, LabelledSurface

STEP = 0.7
"""Distance of samples over the edge of a sub-cell."""
SPAN = 1 << 20
"""Sub-cells along an axis that a key can tell apart."""
BESIDE = (0, 1, -1, SPAN, -SPAN, SPAN**2, -(SPAN**2))
CLEAR = 1e-9
"""Largest distance outside a face of the hull that still counts as inside [mm]."""


def point_regions(
    surface: LabelledSurface, cells: np.ndarray, fractions: np.ndarray, grid_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Labels (C, 8) uint8 and numbers (C, 8) int16 of the points of a lattice.

    Args:
        surface: The surface that was filled.
        cells: Cells of the lattice, shape (C, 3).
        fractions: Filled fraction of each point, shape (C, 8); empty ones stay without a label.
        grid_mm: Edge of a cell.
    """
    size_mm = grid_mm / 2
    bits = np.array([[p >> 2, p >> 1 & 1, p & 1] for p in range(8)])
    filled = np.flatnonzero(fractions.ravel() > 0.0)
    sub_cells = (2 * cells.astype(np.int64)[:, None, :] + bits).reshape(-1, 3)[filled]
    key = _key(sub_cells)
    order = np.argsort(key)
    ordered = key[order]
    marked = np.zeros(len(filled), dtype=np.uint8)
    number = np.full(len(filled), NO_NUMBER, dtype=np.int16)
    there, face_labels, face_numbers = _occupied(surface, size_mm)
    for offset in BESIDE:
        spot = np.minimum(np.searchsorted(ordered, there + offset), len(ordered) - 1)
        met = np.flatnonzero(ordered[spot] == there + offset)
        point = order[spot[met]]
        marked[point] |= face_labels[met]
        number[point] = np.maximum(number[point], face_numbers[met])
    # Sub-cell s spans (s - 1) to s times its size.
    _fill_pins(surface, (sub_cells - 0.5) * size_mm, marked, number)
    labels = np.zeros(fractions.size, dtype=np.uint8)
    numbers = np.full(fractions.size, NO_NUMBER, dtype=np.int16)
    labels[filled], numbers[filled] = marked, number
    return labels.reshape(fractions.shape), numbers.reshape(fractions.shape)


def _occupied(
    surface: LabelledSurface, size_mm: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Keys of sub-cells that faces pass through, and the labels and numbers met in each."""
    points, face = _samples(surface.points_mm[surface.faces], STEP * size_mm)
    key = _key(np.floor(points / size_mm).astype(np.int64) + 1)
    order = np.argsort(key)
    key, face = key[order], face[order]
    begin = np.flatnonzero(np.r_[True, key[1:] != key[:-1]])
    labels = np.bitwise_or.reduceat(surface.labels[face], begin)
    return key[begin], labels, np.maximum.reduceat(surface.numbers[face], begin)


def _samples(corners: np.ndarray, step_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """Points on triangles (M, 3, 3), at most `step_mm` apart, and the triangle of each."""
    length = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2)
    turn = (np.argmax(length, axis=1)[:, None] + np.arange(3)) % 3
    first, second, tip = np.moveaxis(np.take_along_axis(corners, turn[:, :, None], axis=1), 1, 0)
    longest = length.max(axis=1)
    twice_area = np.linalg.norm(np.cross(second - first, tip - first), axis=1)
    rows = np.ceil(twice_area / np.maximum(longest, 1e-300) / step_mm).astype(np.int64) + 1
    face, row = _counted(rows)
    share = row / np.maximum(rows[face] - 1, 1)
    places = np.ceil(share * longest[face] / step_mm).astype(np.int64) + 1
    line, place = _counted(places)
    along = (place / np.maximum(places[line] - 1, 1))[:, None]
    face, share = face[line], share[line][:, None]
    base = (1.0 - along) * first[face] + along * second[face]
    return (1.0 - share) * tip[face] + share * base, face


def _counted(counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Owner and running number of `counts[i]` things of each owner i."""
    owner = np.repeat(np.arange(len(counts)), counts)
    return owner, np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)


def _fill_pins(
    surface: LabelledSurface, points_mm: np.ndarray, labels: np.ndarray, numbers: np.ndarray
) -> None:
    """Mark the points inside each pin, in place."""
    from scipy.spatial import ConvexHull, KDTree

    pins = surface.has(Label.PIN)
    if not pins.any():
        return
    tree = KDTree(points_mm)
    for pin in np.unique(surface.numbers[pins]):
        corners = surface.points_mm[np.unique(surface.faces[pins & (surface.numbers == pin)])]
        centre = (corners.min(axis=0) + corners.max(axis=0)) / 2
        reach = float(np.linalg.norm(corners - centre, axis=1).max())
        near = np.asarray(tree.query_ball_point(centre, reach), dtype=np.int64)
        planes = ConvexHull(corners).equations
        within = near[(points_mm[near] @ planes[:, :3].T + planes[:, 3] <= CLEAR).all(axis=1)]
        labels[within] |= np.uint8(Label.PIN)
        numbers[within] = pin


def _key(sub_cells: np.ndarray) -> np.ndarray:
    """One number per sub-cell (N, 3), shape (N,), int64."""
    shifted = sub_cells + SPAN // 2
    return (shifted[:, 0] * SPAN + shifted[:, 1]) * SPAN + shifted[:, 2]
