"""The generalised winding number of triangles on a grid: about 1 inside, 0 outside.

Jacobson, Kavan and Sorkine-Hornung, Robust inside-outside segmentation using generalized winding
numbers, 2013: how often a surface goes round a place, also where it is cracked, open, doubled or
cut by itself. It is the potential of a layer of dipoles along the normals (Barill and others, Fast
winding numbers for soups and clouds, 2018), so it solves Poisson's equation, laplace(w) = -div(n),
which the fast Fourier transform does for all of a grid at once. Normals are spread over about a
step, so w passes 1/2 on the surface within a small part of a step, and smoothly.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

PADDING = 0.2
"""Free room on each side over the longest side: the transform repeats the body for ever."""
BLUR_STEPS = 0.7
"""Standard deviation of the spread of a normal, in steps."""
SAMPLES_PER_STEP = 1.5
CLUSTER_STEPS = 8.0
"""Width of what counts as one dipole from the border of the grid, in steps."""
BORDER_PLACES = 9
"""Places along each edge of the grid's border at which the repeated bodies are measured."""


GOLDEN = 0.6180339887
"""Multiples of it, less their whole part, are spread evenly."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Grid:
    """Where the winding number is known."""

    low: np.ndarray
    """Place of the first sample, shape (3,)."""
    step: float
    size: tuple[int, int, int]


def grid_around(points: np.ndarray, step: float) -> Grid:
    """A grid with room around the points (N, 3), of sizes that transform fast."""
    from scipy import fft

    low, high = points.min(axis=0), points.max(axis=0)
    room = PADDING * float((high - low).max())
    wanted = np.ceil((high - low + 2 * room) / step).astype(int).tolist()
    size: list[Any] = [fft.next_fast_len(count, real=True) for count in wanted]
    return Grid(low=low - room, step=step, size=(size[0], size[1], size[2]))


def samples_of(
    points: np.ndarray, faces: np.ndarray, spacing: float
) -> tuple[np.ndarray, np.ndarray]:
    """Places on triangles, none farther apart than the spacing.

    Triangles are halved at their longest edge; slivers, which would become a crowd, get places in a
    row.

    Returns:
        Places (S, 3), and area vectors (S, 3) that add up to those of the triangles.
    """
    left, found = points[faces], []
    while len(left):
        edges = np.roll(left, -1, axis=1) - left
        length = np.linalg.norm(edges, axis=2)
        longest, row = length.argmax(axis=1), np.arange(len(left))
        area = 0.5 * np.cross(edges[:, 0], edges[:, 1])
        # Lower than the spacing: nothing is gained by places beside each other.
        thin = 2.0 * np.linalg.norm(area, axis=1) <= spacing * length[row, longest]
        short = length[row, longest] <= spacing
        found.append((left[short].mean(axis=1), area[short]))
        found.append(_rows(left[thin & ~short], spacing))
        row = row[~(thin | short)]
        start, stop, apex = (left[row, (longest[row] + k) % 3] for k in range(3))
        middle = (start + stop) / 2
        halves = [np.stack([start, middle, apex], 1), np.stack([middle, stop, apex], 1)]
        left = np.concatenate(halves)
    return np.vstack([places for places, _ in found]), np.vstack([areas for _, areas in found])


def _rows(corners: np.ndarray, spacing: float) -> tuple[np.ndarray, np.ndarray]:
    """Places along the longest edge of slivers (M, 3, 3), with the area of the width there."""
    edges = np.roll(corners, -1, axis=1) - corners
    length = np.linalg.norm(edges, axis=2)
    first, row = length.argmax(axis=1), np.arange(len(corners))
    start, stop, apex = (corners[row, (first + k) % 3] for k in range(3))
    along = stop - start
    foot = np.einsum("ij,ij->i", apex - start, along) / np.einsum("ij,ij->i", along, along)
    foot = np.clip(foot, 1e-9, 1.0 - 1e-9)
    area = 0.5 * np.cross(edges[:, 0], edges[:, 1])
    # Needles lie side by side by the thousand: their places are set off against each other, so that
    # together they are as dense as those of a triangle.
    enough = 4.0 * np.linalg.norm(area, axis=1) / spacing**2
    count = np.ceil(np.minimum(length.max(axis=1, initial=0.0) / spacing, enough)).astype(np.int64)
    count = np.maximum(count, 1)
    owner = np.repeat(row, count)
    number = np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)
    share = (number + np.where(count > 2, GOLDEN * row % 1.0, 0.5)[owner]) / count[owner]
    width = np.minimum(share / foot[owner], (1.0 - share) / (1.0 - foot[owner]))
    side = apex - start - foot[:, None] * along
    places = start[owner] + share[:, None] * along[owner] + 0.5 * width[:, None] * side[owner]
    weight = width / np.bincount(owner, width, len(corners))[owner]
    return places, weight[:, None] * area[owner]


def winding_number(places: np.ndarray, areas: np.ndarray, grid: Grid) -> np.ndarray:
    """Winding number at the samples of a grid, shape of the grid, float32.

    Args:
        places: Samples of the surface (S, 3).
        areas: Their area vectors, along the outward normals (S, 3).
        grid: With room around the surface.
    """
    from scipy import fft

    axes = [
        np.asarray(2.0 * np.pi * frequencies(n), dtype=np.float32).reshape(shape)
        for n, frequencies, shape in zip(
            grid.size,
            (np.fft.fftfreq, np.fft.fftfreq, np.fft.rfftfreq),
            ((-1, 1, 1), (1, -1, 1), (1, 1, -1)),
            strict=True,
        )
    ]
    square = axes[0] ** 2 + axes[1] ** 2 + axes[2] ** 2
    total = np.zeros(square.shape, dtype=np.complex64)
    for axis in range(3):
        field = _spread(places, areas[:, axis] / grid.step**2, grid)
        turned: Any = fft.rfftn(field, workers=-1)
        total += 1j * axes[axis] * turned
    square[0, 0, 0] = 1.0
    total *= np.exp(-0.5 * BLUR_STEPS**2 * square) / square
    found: Any = fft.irfftn(total, s=grid.size, workers=-1)
    return found - _of_the_others(found, places, areas, grid)


def _of_the_others(
    found: np.ndarray, places: np.ndarray, areas: np.ndarray, grid: Grid
) -> np.ndarray:
    """What the repeated bodies add to the winding number of the one, and the unknown constant.

    Harmonic within the grid, so a few polynomials hold it, fitted far from the body on the grid's
    border, where the body is as good as a few hundred dipoles. Without an open hole it is nearly
    constant.
    """
    axes = [np.linspace(0, n - 1, BORDER_PLACES) for n in grid.size]
    where = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    ends = np.array(grid.size) - 1.0
    where = where[((where == 0.0) | (where == ends)).any(axis=1)].round()
    middle = ends / 2
    # A cluster acts from where its area is, not from the middle of its cell.
    cell = np.floor((places - grid.low) / (CLUSTER_STEPS * grid.step)).astype(np.int64)
    group = np.ravel_multi_index(tuple(cell.T), tuple(cell.max(axis=0) + 1))
    size = np.linalg.norm(areas, axis=1)
    mass = np.bincount(group, size)
    held = np.flatnonzero(mass > 0.0)
    mass = mass[held, None]
    total = np.column_stack([np.bincount(group, areas[:, k])[held] for k in range(3)])
    centre = np.column_stack([np.bincount(group, places[:, k] * size)[held] for k in range(3)])
    centre /= mass
    away = centre[None] - (grid.low + grid.step * where)[:, None]
    cubed = np.linalg.norm(away, axis=2) ** 3
    true = (np.einsum("qcj,cj->qc", away, total) / cubed).sum(axis=1) / (4.0 * np.pi)
    index = tuple(where.astype(np.int64).T)
    basis = np.stack(_harmonics(*((where - middle) / middle.max()).T))
    fitted = np.linalg.lstsq(basis.T, found[index] - true, rcond=None)[0]
    scale = np.float32(middle.max())
    axes = [
        ((np.arange(n) - m) / scale).astype(np.float32)
        for n, m in zip(grid.size, middle, strict=True)
    ]
    x, y, z = np.meshgrid(*axes, indexing="ij", sparse=True)
    added = np.zeros(grid.size, dtype=np.float32)
    for weight, value in zip(fitted, _harmonics(x, y, z), strict=True):
        added += np.float32(weight) * value
    return added


def _harmonics(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> list[np.ndarray]:
    """Harmonic polynomials up to the third degree."""
    first = [np.ones_like(x), x, y, z]
    second = [x * y, y * z, x * z, x * x - y * y, 2 * z * z - x * x - y * y]
    third = [
        z * (2 * z * z - 3 * x * x - 3 * y * y),
        x * (4 * z * z - x * x - y * y),
        y * (4 * z * z - x * x - y * y),
        z * (x * x - y * y),
        x * y * z,
        x * (x * x - 3 * y * y),
        y * (3 * x * x - y * y),
    ]
    return [*first, *second, *third]


def sampled(values: np.ndarray, grid: Grid, places: np.ndarray) -> np.ndarray:
    """Values of a grid between its samples, linear, shape (N,)."""
    from scipy.ndimage import map_coordinates

    return map_coordinates(values, ((places - grid.low) / grid.step).T, order=1, mode="nearest")


def _spread(places: np.ndarray, weights: np.ndarray, grid: Grid) -> np.ndarray:
    """Weights of places shared among the eight samples around each, float32."""
    where = (places - grid.low) / grid.step
    base = np.floor(where).astype(np.int64)
    part = where - base
    total = np.zeros(int(np.prod(grid.size)))
    for corner in np.ndindex(2, 2, 2):
        share = np.prod(np.where(corner, part, 1.0 - part), axis=1)
        flat = np.ravel_multi_index(tuple((base + corner).T), grid.size)
        total += np.bincount(flat, weights * share, total.size)
    return total.reshape(grid.size).astype(np.float32)
