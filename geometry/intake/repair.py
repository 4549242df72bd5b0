"""A damaged surface remeshed as the border of all that it goes round, and how far that is off it.

For cracks, missing faces, faces that cut through each other, doubled or coplanar ones, and bodies
that were not united: the surface where the generalised winding number is 1/2, whose vertices are
then moved onto the nearest face of the file. Edges are cut by a part of a step, holes are closed as
a soap film would. Whoever accepts it is told both before.

Leaves out: faces that face the wrong way one by one; sheets that go round nothing.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.body.csg_mesh import arrays, closed
from geometry.intake.deviation import deviation
from geometry.intake.winding import SAMPLES_PER_STEP, grid_around, samples_of, winding_number
from geometry.surface.isosurface import isosurface
from geometry.surface.meshlab import crossing_faces
from geometry.surface.surface import face_areas

STEPS = 128
"""Steps along the longest side: 0.3 mm on a finger of 40 mm."""
MOST_PLACES = 3_000_000
"""Samples of a surface beyond which it is a heap of damaged faces: a body takes a tenth of that."""
MOST_SAMPLES = 3_000_000
"""Of the grid; bodies as wide as long get a somewhat wider step."""
INSIDE = 0.5
REACH_STEPS = 1.0
"""How far a vertex is moved onto the file's own faces, in steps."""
MOST_LAYERS = 30.0
"""Area over that of a square as wide as the body: a box has 6, crumpled faces hundreds."""
FLAT_STEPS = 0.1
"""Tolerance within which the new triangles are thinned out, in steps."""
DEBRIS_SHARE = 1e-3
"""Pieces with less than this share of the largest volume are debris."""
ROUNDS = 4


@dataclass(frozen=True, kw_only=True, slots=True)
class Repaired:
    """A closed surface in place of a damaged one; lengths in the unit of the file."""

    points: np.ndarray
    """Vertices, shape (N, 3)."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32, counter-clockwise from outside."""
    step: float
    """Width of the grid."""
    deviation: float
    """Largest distance between what can be seen of the file and the new surface, either way."""
    farthest: tuple[float, float, float]
    """Where that is."""
    closed_width: float
    """About the width of the widest hole that was closed; 0 without one."""
    bodies: int
    """Separate bodies of any size; more than one is not a membrane."""


def remeshed(points: np.ndarray, faces: np.ndarray) -> Repaired | None:
    """The border of what triangles go round, or None where they go round nothing or in a heap.

    Args:
        points: Vertices (N, 3).
        faces: Triangles (M, 3); those that are connected face the same way.
    """
    extent = np.ptp(points[faces].reshape(-1, 3), axis=0)
    area = float(face_areas(points, faces).sum())
    if not area <= MOST_LAYERS * float(extent.max()) ** 2:
        # Asked so that what is no number is refused too: halving such triangles would never end.
        return None
    step = max(float(extent.max()) / STEPS, _widest_step(extent))
    spacing = step / SAMPLES_PER_STEP
    if not _expected_places(points, faces, spacing) <= MOST_PLACES:
        return None
    grid = grid_around(points[faces].reshape(-1, 3), step)
    places, areas = samples_of(points, faces, spacing)
    winding = winding_number(places, areas, grid)
    found = isosurface(INSIDE - winding, grid.low, step)
    if found is None:
        return None
    solid, bodies = _largest(*found, step)
    if solid is None:
        return None
    made = _onto(points, faces, *arrays(solid.simplify(FLAT_STEPS * step)), step)
    off = deviation((points, faces), made, (places, areas), step)
    return Repaired(
        points=made[0],
        faces=made[1],
        step=step,
        deviation=off.largest,
        farthest=off.place,
        closed_width=2.0 * off.hole,
        bodies=bodies,
    )


def _expected_places(points: np.ndarray, faces: np.ndarray, spacing: float) -> float:
    """About how many samples triangles take: by area, and slivers by length."""
    corners = points[faces]
    longest = np.linalg.norm(np.roll(corners, -1, axis=1) - corners, axis=2).max(axis=1)
    wanted = np.maximum(face_areas(points, faces) / spacing**2, longest / spacing)
    return float(np.maximum(wanted, 1.0).sum())


def _widest_step(extent: np.ndarray) -> float:
    room = extent + 0.4 * extent.max()
    return float((np.prod(room) / MOST_SAMPLES) ** (1.0 / 3.0))


def _largest(points: np.ndarray, faces: np.ndarray, step: float) -> tuple[Any, int]:
    """The largest body with its hollows, and how many there are that are not debris."""
    solid = closed("the repaired body", points, faces)
    parts = sorted(solid.decompose(), key=lambda part: -part.volume())
    if not parts or parts[0].volume() < step**3:
        return None, 0
    limit = DEBRIS_SHARE * parts[0].volume()
    return parts[0], sum(part.volume() > limit for part in parts)


def _onto(
    points: np.ndarray, faces: np.ndarray, made: np.ndarray, triangles: np.ndarray, step: float
) -> tuple[np.ndarray, np.ndarray]:
    """The new vertices on the nearest faces of the file, where those are near and nothing folds."""
    import pyvista

    padded = np.column_stack([np.full(len(faces), 3), faces]).ravel()
    surface = pyvista.PolyData(points, padded)
    found: Any = surface.find_closest_cell(made, return_closest_point=True)
    nearest = np.asarray(found[1])
    near = np.linalg.norm(nearest - made, axis=1) <= REACH_STEPS * step
    share = near.astype(np.float64)
    for turn in range(ROUNDS):
        placed = made + share[:, None] * (nearest - made)
        bad = crossing_faces(placed, triangles) | _turned(made, placed, triangles)
        if not bad.any():
            return placed, triangles
        # Half as far where triangles fold, and at last not at all.
        share[triangles[bad]] *= 0.5 if turn < ROUNDS - 2 else 0.0
    return made + share[:, None] * (nearest - made), triangles


def _turned(before: np.ndarray, after: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Triangles that face the other way than before, shape (M,), bool."""

    def normals(points: np.ndarray) -> np.ndarray:
        a, b, c = (points[triangles[:, k]] for k in range(3))
        return np.cross(b - a, c - a)

    return np.einsum("ij,ij->i", normals(before), normals(after)) < 0.0
