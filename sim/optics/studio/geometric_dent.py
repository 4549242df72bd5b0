"""A dent by geometry alone: the skin gives way to a rigid object, for previews within a moment.

In the tangent frame of the target, with the skin's height k = q . n over the tangent plane and the
object's lower face at p(u, w) over its lowest point, the object touches first where k - p is
largest; pressed in by d from there, the skin moves along -n by the softened overlap of `dents`,

    o = (k - p) - max(k - p) + d,      disp = s ln(1 + exp(o / s)).

No elasticity, no shear, no twist: the contact stages know those. Holes in the object and faces that
look up do not count.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.surface import closest_point
from geometry.surface.surface_place import smooth_normal
from sim.optics.raster.dents import FOOT_MM, LEAST_MM, SOFTNESS_MM
from workbench.core.base.frames import tangent
from workbench.core.result.results import Skin

REACH = 0.75
"""Vertices farther from the target than this share of the object's width cannot be below it."""
MARGIN_MM = 3.0
"""Added to that, for the foot of the dent."""


def geometric_dent(
    skin: Skin, points_mm: np.ndarray, faces: np.ndarray, *, target_mm: np.ndarray, depth_mm: float
) -> np.ndarray:
    """Displacement of the skin's vertices [mm], shape (V, 3), float32; zero where none is below.

    Args:
        skin: The undeformed skin.
        points_mm: Vertices of the object in its body frame, whose -z is pressed in, shape (N, 3).
        faces: Its triangles, shape (M, 3).
        target_mm: Near the skin, shape (3,).
        depth_mm: From first touch.
    """
    rest = np.asarray(skin.points_mm)
    points, _, face = closest_point(rest, skin.faces, np.asarray(target_mm, dtype=float)[None])
    normal = smooth_normal(skin, int(face[0]), points[0])
    across = tangent(normal)
    offset = rest - points[0]
    places = offset @ np.stack([across, np.cross(normal, across), normal], axis=1)
    width_mm = float(np.ptp(points_mm, axis=0).max())
    near = np.flatnonzero(
        (np.linalg.norm(offset, axis=1) < REACH * width_mm + MARGIN_MM)
        & (np.asarray(skin.normals) @ normal > 0.0)
    )
    gap = places[near, 2] - lower_face_mm(points_mm, faces, places[near, :2])
    moved = np.zeros(len(rest))
    if np.isfinite(gap).any():
        overlap = gap - gap.max() + depth_mm
        moved[near] = SOFTNESS_MM * np.logaddexp(0.0, overlap / SOFTNESS_MM)
    moved[moved < LEAST_MM] = 0.0
    base = float(rest[:, 2].min())
    moved *= np.clip((rest[:, 2] - base) / FOOT_MM, 0.0, 1.0)
    return (-moved[:, None] * normal).astype(np.float32)


def lower_face_mm(points_mm: np.ndarray, faces: np.ndarray, places_mm: np.ndarray) -> np.ndarray:
    """Height of an object's lower face over its lowest point [mm], (N,); inf where it has none.

    Args:
        points_mm: Vertices of the object, shape (P, 3).
        faces: Triangles, shape (M, 3).
        places_mm: x and y in the object's frame, shape (N, 2).
    """
    from geometry.surface.rays import RayCaster

    lowest = float(points_mm[:, 2].min())
    below = np.column_stack([places_mm, np.full(len(places_mm), lowest - 1.0)])
    up = np.tile([0.0, 0.0, 1.0], (len(places_mm), 1))
    distance, face, _ = RayCaster(points_mm, faces).hits(below, up)
    return np.where(face >= 0, distance - 1.0, np.inf)
