"""Closed meshes of spheres, rounded boxes and rounded bodies of revolution, in plain numpy."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

AROUND = 64
"""Facets of a body of revolution."""
ARC_STEP_RAD = np.pi / 24
BOX_STEPS = 6
"""Facets across a rounded edge of a box."""


def sphere(radius_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """A sphere about the origin with poles on Z."""
    polar = np.linspace(-np.pi / 2, np.pi / 2, AROUND // 2 + 1)
    return _revolved(radius_mm * np.cos(polar), radius_mm * np.sin(polar))


def rounded_revolution(
    outline: Sequence[tuple[float, float]], radius_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Body of revolution about Z with rounded edges.

    Args:
        outline: (r, z) from the lower axis point, outward and up to the upper one [mm]; the body
            is convex.
        radius_mm: Rounding radius of its corners; a slanted line's apex on the axis too.
    """
    # Mirrored about the axis the outline is a closed polygon, so that an apex is a corner as well.
    right = np.asarray(outline, dtype=np.float64)
    left = right[(right[:, 0] > 0.0)][::-1] * [-1.0, 1.0]
    path = _rounded_polygon(np.vstack([right, left]), radius_mm)
    half = path[path[:, 0] > 1e-9]
    half = half[np.argsort(_turn_from_below(half))]
    low, high = _axis_crossings(path)
    radius = np.concatenate([[0.0], half[:, 0], [0.0]])
    return _revolved(radius, np.concatenate([[low], half[:, 1], [high]]))


def rounded_box(half_mm: float, radius_mm: float) -> tuple[np.ndarray, np.ndarray]:
    """A cube of half width `half_mm` with edges rounded by `radius_mm`.

    Each point of a fine cube surface is drawn to the inner cube and pushed out by the radius.
    """
    inner = half_mm - radius_mm
    if radius_mm > 0.0:
        arc = half_mm - radius_mm * (1.0 - np.tan(np.linspace(0.0, np.pi / 4, BOX_STEPS + 1)))
        ticks = np.concatenate([-arc[::-1], arc])
    else:
        ticks = np.array([-half_mm, half_mm])
    points, faces = _cube_grid(ticks)
    core = np.clip(points, -inner, inner)
    outward = points - core
    length = np.linalg.norm(outward, axis=1, keepdims=True)
    return core + radius_mm * outward / length if radius_mm > 0.0 else points, faces


def _cube_grid(ticks: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Surface of a cube divided at the ticks, closed and outward."""
    count = len(ticks)
    row, column = (grid.ravel() for grid in np.meshgrid(np.arange(count), np.arange(count)))
    corner = np.arange(count * count).reshape(count, count)[:-1, :-1].ravel()
    # Column (x) runs along with the vertex number, row (y) in strides.
    quads = np.stack([corner, corner + 1, corner + count + 1, corner + count], axis=1)
    split = quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3)
    vertices, faces = [], []
    for axis in range(3):
        for end in (0, count - 1):
            index = np.empty((count * count, 3), dtype=np.int64)
            index[:, axis] = end
            index[:, (axis + 1) % 3] = row
            index[:, (axis + 2) % 3] = column
            faces.append((split if end else split[:, ::-1]) + len(vertices) * count * count)
            vertices.append(index)
    index, inverse = np.unique(np.concatenate(vertices), axis=0, return_inverse=True)
    return ticks[index], inverse.reshape(-1)[np.concatenate(faces)].astype(np.int32)


def _rounded_polygon(corners: np.ndarray, radius_mm: float) -> np.ndarray:
    """A convex counter-clockwise polygon (C, 2) with corners replaced by arcs."""
    if radius_mm <= 0.0:
        return corners
    path = []
    for before, corner, after in zip(
        np.roll(corners, 1, axis=0), corners, np.roll(corners, -1, axis=0), strict=True
    ):
        coming = (corner - before) / np.linalg.norm(corner - before)
        going = (after - corner) / np.linalg.norm(after - corner)
        turn = float(np.arctan2(coming[0] * going[1] - coming[1] * going[0], coming @ going))
        if turn < 1e-9:
            continue
        start = corner - coming * radius_mm * np.tan(turn / 2)
        centre = start + radius_mm * np.array([-coming[1], coming[0]])
        first = np.arctan2(-coming[0], coming[1])
        steps = max(2, int(np.ceil(turn / ARC_STEP_RAD / 2)) * 2)
        angle = first + np.linspace(0.0, turn, steps + 1)
        normals = np.column_stack([np.cos(angle), np.sin(angle)])
        path.append(centre + radius_mm * normals)
    return np.concatenate(path)


def _turn_from_below(points: np.ndarray) -> np.ndarray:
    centre = (points[:, 1].min() + points[:, 1].max()) / 2
    return np.arctan2(points[:, 1] - centre, points[:, 0])


def _axis_crossings(path: np.ndarray) -> tuple[float, float]:
    """Heights at which a closed path symmetric about r = 0 crosses the axis."""
    after = np.roll(path, -1, axis=0)
    touches = path[np.abs(path[:, 0]) < 1e-9, 1].tolist()
    crosses = (path[:, 0] * after[:, 0] < 0.0) & (np.abs(path[:, 0]) >= 1e-9)
    crosses &= np.abs(after[:, 0]) >= 1e-9
    share = path[crosses, 0] / (path[crosses, 0] - after[crosses, 0])
    heights = path[crosses, 1] + share * (after[crosses, 1] - path[crosses, 1])
    both = [*touches, *heights.tolist()]
    return min(both), max(both)


def _revolved(radius: np.ndarray, height: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Surface of an (r, z) path turned about Z; the path starts and ends on the axis, going up."""
    azimuth = 2 * np.pi * np.arange(AROUND) / AROUND
    inner = len(radius) - 2
    ring = np.stack(
        [
            np.outer(radius[1:-1], np.cos(azimuth)),
            np.outer(radius[1:-1], np.sin(azimuth)),
            np.repeat(height[1:-1, None], AROUND, axis=1),
        ],
        axis=-1,
    ).reshape(-1, 3)
    points = np.vstack([ring, [0.0, 0.0, height[0]], [0.0, 0.0, height[-1]]])
    number = np.arange(inner * AROUND).reshape(inner, AROUND)
    beside = np.roll(number, -1, axis=1)
    low, low_beside, up, up_beside = number[:-1], beside[:-1], number[1:], beside[1:]
    mantle = [np.stack([low, low_beside, up_beside], -1), np.stack([low, up_beside, up], -1)]
    bottom, top = inner * AROUND, inner * AROUND + 1
    caps = [
        np.stack([beside[0], number[0], np.full(AROUND, bottom)], -1),
        np.stack([number[-1], beside[-1], np.full(AROUND, top)], -1),
    ]
    faces = np.concatenate([part.reshape(-1, 3) for part in (*mantle, *caps)])
    return points, faces.astype(np.int32)
