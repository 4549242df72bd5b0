"""Whether a point lies within a skin, and how far the skin is from the axis there."""

from __future__ import annotations

import numpy as np

from workbench.core.result.results import Skin

JUST_ABOVE_BASE_MM = 0.05
"""Height of radial rays over the base [mm]: a ray in the rim itself may slip past the skin."""


def inside(skin: Skin, points_mm: np.ndarray) -> np.ndarray:
    """Whether points above the base lie within a skin that is open at its base, shape (N,) bool.

    A ray upward leaves the skin through the face it meets first, or the point was outside.
    """
    from geometry.surface.rays import RayCaster

    # Slightly off +Z: a ray along the axis or a straight wall would graze edges and vertices.
    upward = np.array([0.0131, 0.0217, 1.0])
    upward /= np.linalg.norm(upward)
    direction = np.broadcast_to(upward, points_mm.shape)
    _, face, _ = RayCaster(skin.points_mm, skin.faces).hits(points_mm, direction)
    corners = skin.points_mm[skin.faces[face]]
    facing = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) @ upward
    return (face >= 0) & (facing > 0.0)


def wall_radius(skin: Skin, point: np.ndarray) -> float:
    """Distance [mm] from the axis to the skin at a point's azimuth and height; inf if none."""
    from geometry.surface.rays import RayCaster

    radius = float(np.hypot(point[0], point[1]))
    around = point[:2] / radius if radius > 0.0 else np.array([1.0, 0.0])
    origin = np.array([[0.0, 0.0, point[2]]])
    direction = np.array([[around[0], around[1], 0.0]])
    return float(RayCaster(skin.points_mm, skin.faces).hits(origin, direction)[0][0])
