"""How far a remeshed surface is off the faces of the file that can be seen, either way.

A face can be seen where the place a hair above it is not inside: also a fin or the wall of a slot
thinner than the remesh tells apart, which is just what it loses. What lies inside another body of
the same file cannot. The walls of gaps narrower than a hair are joints.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.intake.solid_angles import WindingNumber
from geometry.surface.isosurface import distance_mm

HAIR_STEPS = 0.1
"""How far above a face it is looked whether that is inside, in steps."""
INSIDE = 0.4
"""Winding number above which a place is inside: 1/2 is beside a loose sheet within a body."""
LID_STEPS = 1.0
"""Distance from the file beyond which a new face closes a hole, in steps."""
DRAWN_IN = 0.1
"""Corners are looked at this share of the way to the middle of their triangle."""
MOST_SAMPLES = 60_000
BETWEEN_STEPS = 0.1
"""What may be missed between samples, which is added, in steps: 0.07 on crossing balls."""
AT_ONCE = 1000
"""Places of which it is asked at once whether they can be seen, the farthest first."""

Triangles = tuple[np.ndarray, np.ndarray]
"""Vertices (N, 3) and triangles (M, 3)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Deviation:
    """Distances in the unit of the file."""

    largest: float
    """Between what can be seen of the file and the new surface, holes left out."""
    place: tuple[float, float, float]
    """Where that is."""
    hole: float
    """Largest distance from the file of what closes its holes; 0 without one."""


def deviation(
    file: Triangles, made: Triangles, samples: tuple[np.ndarray, np.ndarray], step: float
) -> Deviation:
    """How far two surfaces are apart.

    Args:
        file: As given, facing outward.
        made: The new surface, closed.
        samples: Places on the file's triangles and their area vectors, (S, 3) each.
        step: Width of the grid of the remesh.
    """
    there, place = _missed(file, made, samples, step)
    points, faces = made
    places = np.vstack([points, points[faces].mean(axis=1)])
    back = distance_mm(*file, places)
    lid = back > LID_STEPS * step
    on_lid = lid[len(points) :] | lid[faces].any(axis=1)
    # Beside a hole what closes it begins at the rim, and is no deviation of what the file has.
    body = ~lid
    if on_lid.any():
        body &= distance_mm(points, faces[on_lid], places) > step
    here = float(back[body].max(initial=0.0))
    if here > there:
        place = places[body][back[body].argmax()]
    x, y, z = place.tolist()
    return Deviation(
        largest=max(there, here) + BETWEEN_STEPS * step,
        place=(x, y, z),
        hole=float(back[lid].max(initial=0.0)),
    )


def _missed(
    file: Triangles, made: Triangles, samples: tuple[np.ndarray, np.ndarray], step: float
) -> tuple[float, np.ndarray]:
    """Largest distance of what can be seen of the file from the new surface, and its place."""
    points, faces = file
    stride = max(1, len(samples[0]) // MOST_SAMPLES)
    places, areas = (each[::stride] for each in samples)
    corners = points[faces]
    middle = corners.mean(axis=1, keepdims=True)
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    # Extremes are at vertices; whether those can be seen is told by each of their triangles.
    far = np.concatenate([distance_mm(*made, places), distance_mm(*made, points)[faces].ravel()])
    drawn_in = corners + DRAWN_IN * (middle - corners)
    places = np.vstack([places, drawn_in.reshape(-1, 3)])
    normals = np.vstack([areas, np.repeat(normals, 3, axis=0)])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    chosen = _farthest_of_each_cell(places, normals, far, step)
    winding = WindingNumber(points, faces)
    for start in range(0, len(chosen), AT_ONCE):
        some = chosen[start : start + AT_ONCE]
        above = places[some] + HAIR_STEPS * step * normals[some]
        seen = winding.at(above) <= INSIDE
        if seen.any():
            first = some[seen.argmax()]
            return float(far[first]), places[first]
    return 0.0, points[faces[0, 0]]


def _farthest_of_each_cell(
    places: np.ndarray, normals: np.ndarray, far: np.ndarray, step: float
) -> np.ndarray:
    """Numbers of places, the farthest first, one for all that face one way in a cell.

    A cell is as wide as a quarter to a half of the distance, which differs within it by no more.
    """
    order = np.argsort(-far, kind="stable")
    octave = np.floor(np.log2(np.maximum(far[order] / step, 1.0)))
    cell = 0.5 * step * 2.0**octave
    key = np.column_stack(
        [np.floor(places[order] / cell[:, None]), np.round(normals[order]), octave]
    ).astype(np.int64)
    key -= key.min(axis=0)
    size = key.max(axis=0) + 1
    flat = np.zeros(len(key), dtype=np.int64)
    for column, count in zip(key.T, size.tolist(), strict=True):
        flat = flat * count + column
    return order[np.sort(np.unique(flat, return_index=True)[1])]
