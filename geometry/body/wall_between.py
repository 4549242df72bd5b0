"""The wall between the outer and the inner side of a body that stands on z = 0.

Distances go from either side to the triangles of the other: a flat side has corners only at its
ends, and a slot in the outside may come near to the middle of a flat inside, or through it.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from geometry.body.csg_mesh import arrays
from geometry.surface.isosurface import distance_mm
from geometry.surface.offset import inside
from geometry.surface.spread import spread
from geometry.surface.surface import FLAT_MM, on_plane

SAMPLES = 8000
"""Places of each side that are looked at beside its vertices: about one for each mm2."""


class Wall(NamedTuple):
    """How thick a wall is."""

    least_mm: float
    """Negative where the inner side comes through the outer."""
    least_at_mm: np.ndarray
    """Shape (3,)."""
    most_mm: float
    """Longest way from the inner side to the outer."""


class _Side(NamedTuple):
    """One side of a wall, as a closed body and its surface above the base plane."""

    points_mm: np.ndarray
    faces: np.ndarray
    upright: np.ndarray
    """Triangles that are not on z = 0, shape (M, 3)."""
    places_mm: np.ndarray
    """Places looked at, above z = 0, shape (P, 3)."""


def wall_between(outer: Any, core: Any) -> Wall:
    """The wall between two manifolds, cut flat on z = 0."""
    outside, inner = _side(outer), _side(core)
    outward_mm = distance_mm(outside.points_mm, outside.upright, inner.places_mm)
    within = inside(outside.points_mm, outside.faces, inner.places_mm)
    inward_mm = distance_mm(inner.points_mm, inner.upright, outside.places_mm)
    through = inside(inner.points_mm, inner.faces, outside.places_mm)
    places = np.concatenate([inner.places_mm, outside.places_mm])
    signed = np.concatenate(
        [np.where(within, outward_mm, -outward_mm), np.where(through, -inward_mm, inward_mm)]
    )
    least = int(np.argmin(signed))
    return Wall(float(signed[least]), places[least], float(outward_mm.max()))


def _side(body: Any) -> _Side:
    points, faces = arrays(body)
    points[np.abs(points[:, 2]) < FLAT_MM, 2] = 0.0
    upright = faces[~on_plane(points, faces)]
    places = np.concatenate(
        [points[np.unique(upright)], spread(points, upright, SAMPLES).points_mm]
    )
    return _Side(points, faces, upright, places[places[:, 2] > FLAT_MM])
