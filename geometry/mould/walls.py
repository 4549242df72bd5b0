"""How thin a printed part is: the largest ball inside it that touches its surface at a place.

A ball is grown on the inside of a place of the surface until it touches the surface once more: it
begins as large as the way straight through the part allows, and shrinks until nothing of the
surface is in it. Its diameter is the wall, if both places that it touches look apart; else it sits
in an edge. Where the two sides run together and end in each other, as beside a parting, the part
gets thinner and thinner toward the end, which is a feather edge and no wall: the printer rounds it.

Source: Ma, Bae and Choi, 3D medial axis point approximation using nearest neighbors and the normal
field, The Visual Computer 28, 2012 (shrinking balls).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from geometry.mould.castability import Worst
from geometry.mould.feathers import Feathers
from geometry.surface.rays import RayCaster
from geometry.surface.spread import spread
from geometry.surface.surface import closest_point, face_normals

SAMPLES = 8000
START_MM = 1e-3
"""Depth below the surface at which a ray starts [mm]."""
OPPOSED_COSINE = 0.7
"""A wall is between places that look apart to within 45 degrees."""
SHRINKS = 10
SETTLED = 1e-3
"""A ball that would shrink by less has settled [1]."""
CLOUD = 20_000
"""Places of the surface that balls shrink from at first."""
BATCH = 32
"""Smallest balls that are then shrunk from the triangles themselves, at a time."""
MOST_BATCHES = 20
NOWHERE = Worst(np.inf, (0.0, 0.0, 0.0))


class Places(NamedTuple):
    """Places of a surface."""

    points_mm: np.ndarray
    """Shape (P, 3)."""
    normals: np.ndarray
    """Outward, shape (P, 3)."""
    face: np.ndarray
    """Triangle of each, shape (P,); -1 where it is not known."""

    def at(self, rows: np.ndarray) -> Places:
        """Some of them."""
        return Places(self.points_mm[rows], self.normals[rows], self.face[rows])


Nearest = Callable[[np.ndarray], Places]
"""What of a surface is nearest to places inside it."""


def thinnest_wall(points_mm: np.ndarray, faces: np.ndarray, *, edges: bool = False) -> Worst:
    """Thinnest wall of a closed mesh [mm] and the middle of it; inf when there is none.

    Args:
        edges: Count feather edges too, as what they are just before they end.
    """
    from scipy.spatial import KDTree

    points_mm = np.asarray(points_mm, dtype=np.float64)
    cloud, normals = spread(points_mm, faces, CLOUD), face_normals(points_mm, faces)
    tree = KDTree(cloud.points_mm)
    feathers = None if edges else Feathers(points_mm, faces)

    def roughly(places_mm: np.ndarray) -> Places:
        rows = np.asarray(tree.query(places_mm)[1])
        return Places(cloud.points_mm[rows], cloud.normals[rows], np.full(rows.shape, -1))

    def exactly(places_mm: np.ndarray) -> Places:
        near, _, face = closest_point(points_mm, faces, places_mm)
        return Places(near, normals[face], face)

    start, opposite = _across(points_mm, faces)
    if feathers is not None:
        kept = ~feathers.end(start, opposite)
        start, opposite = start.at(kept), opposite.at(kept)
    # A cloud has gaps, so its balls are a little too large; the smallest are looked at again.
    rough, _ = _balls_mm(start, opposite, roughly)
    order, best = np.argsort(rough, kind="stable"), NOWHERE
    for batch in range(MOST_BATCHES):
        few = order[BATCH * batch : BATCH * (batch + 1)]
        if not len(few) or rough[few[0]] >= best.value:
            break
        walls, touched = _balls_mm(start.at(few), opposite.at(few), exactly)
        if feathers is not None:
            walls[feathers.end(exactly(start.points_mm[few]), touched)] = np.inf
        worst = int(np.argmin(walls))
        if walls[worst] < best.value:
            middle = start.points_mm[few[worst]] - walls[worst] / 2 * start.normals[few[worst]]
            x, y, z = (float(value) for value in middle)
            best = Worst(float(walls[worst]), (x, y, z))
    return best


def _across(points_mm: np.ndarray, faces: np.ndarray) -> tuple[Places, Places]:
    """Places of a surface and those straight across the part, where the two look apart."""
    places = spread(points_mm, faces, SAMPLES)
    inward = -places.normals
    start = places.points_mm + START_MM * inward
    length, face, _ = RayCaster(points_mm, faces).hits(start, inward)
    normals = face_normals(points_mm, faces)[face]
    met = (face >= 0) & (np.einsum("ij,ij->i", normals, inward) > OPPOSED_COSINE)
    ends = start[met] + length[met, None] * inward[met]
    return (
        Places(places.points_mm[met], places.normals[met], np.full(int(met.sum()), -1)),
        Places(ends, normals[met], face[met]),
    )


def _balls_mm(start: Places, opposite: Places, nearest: Nearest) -> tuple[np.ndarray, Places]:
    """Diameter of the ball at each place [mm], shape (P,), and where it touches once more.

    Inf where it touches no opposite side.
    """
    radius = np.linalg.norm(start.points_mm - opposite.points_mm, axis=1) / 2
    touched = Places(*(values.copy() for values in opposite))
    moving = np.arange(len(radius))
    for _ in range(SHRINKS):
        near = nearest(start.points_mm[moving] - radius[moving, None] * start.normals[moving])
        toward = start.points_mm[moving] - near.points_mm
        height = np.maximum(np.einsum("ij,ij->i", toward, start.normals[moving]), 1e-12)
        shrunk = np.einsum("ij,ij->i", toward, toward) / (2.0 * height)
        smaller = shrunk < (1.0 - SETTLED) * radius[moving]
        moving = moving[smaller]
        if not len(moving):
            break
        radius[moving] = shrunk[smaller]
        for values, found in zip(touched, near, strict=True):
            values[moving] = found[smaller]
    facing = -np.einsum("ij,ij->i", touched.normals, start.normals)
    return np.where(facing > OPPOSED_COSINE, 2.0 * radius, np.inf), touched
