"""Which way the camera lies from a point of the skin, as light goes: bent at the cavity wall.

The camera's ray through a point behind a refracting wall is found by aiming: a ray toward the aim
is cast on the wall and bent there; the aim then moves by what the bent ray missed the point. The
miss shrinks by a half to a tenth each time. Any wall will do, and no image is needed.

Leaves out: second solutions behind a wall that folds, and what blocks the view.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.rays import RayCaster
from sim.optics.camera.refraction import refract
from workbench.core.design.camera import Camera
from workbench.core.result.results import MembraneMesh, Skin

STEPS = (1.0,) * 6 + (0.5,) * 6 + (0.25,) * 6
"""Share of the miss that the aim moves by, time after time: where the wall's curvature jumps, from
a cylinder to its dome, whole steps swing to and fro."""
MISS_MM = 0.05
"""A ray that passes a point nearer than this has found it [mm]."""


def directions_to_camera(
    points_mm: np.ndarray, mesh: MembraneMesh, camera: Camera, refractive_index: float
) -> np.ndarray:
    """Unit vectors from points in the solid along the bent ray to the camera, shape (N, 3).

    A point whose ray is not found (total reflection, or far outside the view) takes the direction
    of the nearest point whose ray was, and the straight line if there is none.

    Args:
        points_mm: Points between wall and skin [mm], shape (N, 3).
        mesh: The skins.
        camera: The camera, in the cavity.
        refractive_index: Of the solid [1].
    """
    eye = np.asarray(camera.position_mm, dtype=np.float64)
    points = np.asarray(points_mm, dtype=np.float64)
    straight = _unit(eye - points)
    if refractive_index == 1.0:
        return straight
    found, miss_mm = _aim(points, eye, mesh.cavity, refractive_index)
    lost = miss_mm > MISS_MM
    if lost.all():
        return straight
    if lost.any():
        from scipy.spatial import KDTree

        nearest = KDTree(points[~lost]).query(points[lost])[1]
        found[lost] = found[~lost][nearest]
    return found


def _aim(
    points: np.ndarray, eye: np.ndarray, wall: Skin, index: float
) -> tuple[np.ndarray, np.ndarray]:
    """Direction of the best ray of each point, shape (N, 3), and how far it passes [mm], (N,)."""
    caster = RayCaster(wall.points_mm, wall.faces)
    aim = points.copy()
    best = np.full(len(points), np.inf)
    found = _unit(eye - points)
    unsolved = np.arange(len(points))
    for step in STEPS:
        start, direction = _bent(caster, wall, eye, _unit(aim[unsolved] - eye), index)
        along = np.einsum("ij,ij->i", points[unsolved] - start, direction)
        gap = points[unsolved] - start - along[:, None] * direction
        miss = np.where(along > 0.0, np.linalg.norm(gap, axis=1), np.inf)
        better = miss < best[unsolved]
        chosen = unsolved[better]
        best[chosen], found[chosen] = miss[better], -direction[better]
        aim[unsolved] += step * gap
        unsolved = unsolved[best[unsolved] > 0.1 * MISS_MM]
        if not unsolved.size:
            break
    return found, best


def _bent(
    caster: RayCaster, wall: Skin, eye: np.ndarray, direction: np.ndarray, index: float
) -> tuple[np.ndarray, np.ndarray]:
    """Where the camera's rays go on behind the wall: starts [mm] and unit directions."""
    origin = np.broadcast_to(eye, direction.shape)
    distance, face, weights = caster.hits(origin, direction)
    met = np.flatnonzero(face >= 0)
    start, bent = origin.copy(), direction.copy()
    start[met] += distance[met, None] * direction[met]
    normal = np.einsum("nk,nkd->nd", weights[met], wall.normals[wall.faces[face[met]]])
    normal = _unit(normal)
    # Seen from outside the cavity a wall is not where the eye's rays enter; they go straight on.
    enters = np.einsum("ij,ij->i", normal, direction[met]) > 0.0
    met, normal = met[enters], normal[enters]
    bent[met], _ = refract(direction[met], normal, index_from=1.0, index_to=index)
    return start, bent


def _unit(vectors: np.ndarray) -> np.ndarray:
    return vectors / np.maximum(np.linalg.norm(vectors, axis=1, keepdims=True), 1e-12)
