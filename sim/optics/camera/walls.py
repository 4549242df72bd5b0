"""Camera rays through the clear body, exactly, for any form of cavity.

A ray leaves the camera in air, enters the support where it meets the cavity's wall, and is bent by
Snell's law with the smooth normal of the mesh (flat normals leave facets of 0.9 px). In a cavity
that is not convex it may leave the support again before it reaches the skin, cross air, and enter
once more: it is followed through every wall until the segment that meets the undeformed skin.
Transmittances multiply. Left out: reflected light, and what an absorbing body would take away.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.camera.refraction import refract
from workbench.core.result.results import Skin

MOST_WALLS = 9
"""Walls that a ray is followed through; a ray that meets more carries almost no light."""
STEP_PAST_MM = 1e-3
"""How far a ray starts behind the wall that it crossed [mm]; single precision holds 4e-6."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Segments:
    """The last straight piece of each of N rays, inside the clear body."""

    origin_mm: np.ndarray
    """Where it starts, on the last wall or at the camera [mm], shape (N, 3), float64."""
    direction: np.ndarray
    """Unit directions away from the camera, shape (N, 3), float64."""
    transmittance: np.ndarray
    """Share of light that passes all walls, shape (N,), float64."""
    travelled_mm: np.ndarray
    """Length of the way from the camera to the origin [mm], shape (N,), float64."""
    walls: np.ndarray
    """Walls crossed, shape (N,), int32; -1 where the ray is reflected back totally."""


def last_segments(
    direction: np.ndarray, camera_mm: np.ndarray, *, cavity: Skin, seen: Skin, index: float
) -> Segments:
    """Follow rays from the camera to the skin.

    A ray that misses the cavity's wall, and every ray at index 1, goes straight on.

    Args:
        direction: Unit directions in the cavity, shape (N, 3).
        camera_mm: Where they start [mm], shape (3,).
        cavity: Inner face of the support, normals out of the sensor.
        seen: The undeformed skin that ends a ray.
        index: Refractive index of support and elastomer [1]; the cavity holds air.
    """
    from geometry.surface.rays import RayCaster

    count = len(direction)
    origin = np.tile(np.asarray(camera_mm, dtype=np.float64), (count, 1))
    way = np.array(direction, dtype=np.float64)
    transmittance, travelled = np.ones(count), np.zeros(count)
    walls = np.zeros(count, dtype=np.int32)
    going = np.arange(count) if index != 1.0 else np.zeros(0, dtype=np.int64)
    wall, skin = RayCaster(cavity.points_mm, cavity.faces), RayCaster(seen.points_mm, seen.faces)
    for number in range(MOST_WALLS):
        if not going.size:
            break
        entering = number % 2 == 0
        start = origin[going] + (STEP_PAST_MM if number else 0.0) * way[going]
        distance, face, weights = wall.hits(start, way[going])
        crossing = (face >= 0) & (_side(cavity, face, way[going]) == (1 if entering else -1))
        if not entering:
            crossing &= distance < skin.hits(start, way[going])[0]
        going, face, weights = going[crossing], face[crossing], weights[crossing]
        length = distance[crossing] + (STEP_PAST_MM if number else 0.0)
        origin[going] += length[:, None] * way[going]
        travelled[going] += length
        normal = np.einsum("nk,nkd->nd", weights, cavity.normals[cavity.faces[face]])
        normal *= (1.0 if entering else -1.0) / np.linalg.norm(normal, axis=1, keepdims=True)
        media = {"index_from": 1.0, "index_to": index}
        if not entering:
            media = {"index_from": index, "index_to": 1.0}
        way[going], passing = refract(way[going], normal, **media)
        transmittance[going] *= passing
        walls[going] = np.where(passing > 0.0, number + 1, -1)
        going = going[passing > 0.0]
    return Segments(
        origin_mm=origin,
        direction=way,
        transmittance=transmittance,
        travelled_mm=travelled,
        walls=walls,
    )


def _side(skin: Skin, face: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """1 where a ray passes its triangle outward, -1 inward, shape (N,)."""
    first, second, third = (skin.points_mm[skin.faces[face, corner]] for corner in range(3))
    outward = np.cross(second - first, third - first)
    return np.where(np.einsum("ij,ij->i", outward, direction) > 0.0, 1, -1)
