"""A body that is a shell already: hollow from below, so its own two sides are outer and inner.

Cut flat on z = 0, such a body's surface above the cut falls into two pieces, each with one rim: the
outside, and the inside of the cavity. Either is closed with a lid on z = 0.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from geometry.body.csg_mesh import closed
from geometry.intake.labelling import flat_arrays
from geometry.surface.holes import Damaged, close_holes
from geometry.surface.surface import face_areas, mesh_volume, on_plane, pieces

LEAST_SHARE = 0.25
"""A cavity with less of the volume inside the outer side is a bore, not the inside of a shell."""
STRAY_SHARE = 1e-4
"""Pieces with less of the area than this are nothing."""


def outer_and_inner(body: Any) -> tuple[Any, Any] | None:
    """The filled outer body and what hollows it, as manifolds; None where it is no shell.

    Args:
        body: Manifold cut flat on z = 0, above which all of it lies; faces keep their numbers.
    """
    points, faces, numbers = flat_arrays(body)
    upright = ~on_plane(points, faces)
    faces, numbers = faces[upright], numbers[upright]
    piece = pieces(faces)
    area = np.bincount(piece, face_areas(points, faces))
    kept = np.flatnonzero(area > STRAY_SHARE * area.sum())
    if len(kept) != 2:
        return None
    lidded = [_lidded(points, faces[piece == k], numbers[piece == k]) for k in kept]
    bodies = [found for found in lidded if found is not None]
    if len(bodies) != 2:
        return None
    bodies.sort(key=lambda found: -abs(found[0]))
    (outer_mm3, *outer), (inner_mm3, points, faces, numbers) = bodies
    # Seen from the elastomer the inside faces into the cavity.
    if not (outer_mm3 > 0.0 > inner_mm3) or -inner_mm3 < LEAST_SHARE * outer_mm3:
        return None
    whole = closed("the outer side", *outer)
    return whole, closed("the inner side", points, faces[:, ::-1], numbers)


def _lidded(
    points: np.ndarray, faces: np.ndarray, numbers: np.ndarray
) -> tuple[float, np.ndarray, np.ndarray, np.ndarray] | None:
    """Volume, vertices, triangles and their numbers with a lid; None where there is no one lid."""
    used, packed = np.unique(faces, return_inverse=True)
    notes: list[str] = []
    try:
        points, faces = close_holes(points[used], packed.reshape(-1, 3), "side", notes)
    except Damaged:
        return None
    if len(notes) != 1:
        return None
    lid = np.full(len(faces) - len(numbers), numbers[0])
    return mesh_volume(points, faces), points, faces, np.concatenate([numbers, lid])
