"""Rays against a triangle mesh by Embree, without a mesh library in between.

Embree works in float32 and finds which triangle a ray meets; distance and barycentric coordinates
are then computed again in float64 from that triangle's plane, so they are exact to about 1e-12 mm
instead of 1e-5 mm. A ray through the very corner of several triangles may miss them all (about 1
in 200 rays aimed exactly at vertices); callers who cannot accept that cast again a hair beside.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from workbench.core.base.check import expect


class RayCaster:
    """A triangle mesh ready for rays. Distances are in units of the direction's length."""

    def __init__(self, points_mm: np.ndarray, faces: np.ndarray) -> None:
        """Build the tree.

        Args:
            points_mm: Vertices [mm], shape (N, 3).
            faces: Triangles, shape (M, 3).
        """
        from embreex import rtcore_scene
        from embreex.mesh_construction import TriangleMesh

        expect(points_mm, "N 3", name="points")
        expect(faces, "M 3", name="faces")
        corners = np.asarray(points_mm, dtype=np.float64)[faces]
        self._origin = corners[:, 0]
        self._edge_1 = corners[:, 1] - corners[:, 0]
        self._edge_2 = corners[:, 2] - corners[:, 0]
        self._normal = np.cross(self._edge_1, self._edge_2)
        scene: Any = rtcore_scene
        self._scene = scene.EmbreeScene(robust=True)
        vertices = np.ascontiguousarray(points_mm, dtype=np.float32)
        TriangleMesh(self._scene, vertices, np.ascontiguousarray(faces, dtype=np.int32))

    def hits(
        self, origins: np.ndarray, directions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """First triangle along each ray.

        Args:
            origins: Starts [mm], shape (R, 3).
            directions: Directions, any length, shape (R, 3).

        Returns:
            Distance in direction lengths, shape (R,), float64, inf for a miss; face, shape (R,),
            int32, -1 for a miss; weights of the face's three corners, shape (R, 3), 0 for a miss.
        """
        face = self._scene.run(_single(origins), _single(directions))
        distance = np.full(len(face), np.inf)
        weights = np.zeros((len(face), 3))
        found = np.flatnonzero(face >= 0)
        if len(found):
            start = np.asarray(origins, dtype=np.float64)[found]
            along = np.asarray(directions, dtype=np.float64)[found]
            distance[found], weights[found] = self._refine(start, along, face[found])
        return distance, face, weights

    def first_faces(
        self, origins: np.ndarray, directions: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """First triangle along each ray as Embree finds it, in single precision, for many rays.

        Embree does not hold Python's lock, so callers may cast parts of their rays in threads.

        Args:
            origins: Starts [mm], shape (R, 3), float32.
            directions: Directions, any length, shape (R, 3), float32.

        Returns:
            Face, shape (R,), int32, -1 for a miss; weights of its second and third corner, shape
            (R,) each, float32.
        """
        found = self._scene.run(_single(origins), _single(directions), output=1)
        return found["primID"], found["u"], found["v"]

    def occluded(
        self, origins: np.ndarray, directions: np.ndarray, max_distance: np.ndarray | float
    ) -> np.ndarray:
        """Whether anything lies on each ray nearer than `max_distance`, shape (R,), bool.

        Args:
            max_distance: In direction lengths, one for all rays or shape (R,).
        """
        limit = np.broadcast_to(np.asarray(max_distance, dtype=np.float32), (len(origins),))
        limit = np.array(limit)  # Embree writes here, and a broadcast view is read-only.
        return self._scene.run(_single(origins), _single(directions), limit, query="OCCLUDED") >= 0

    def _refine(
        self, start: np.ndarray, along: np.ndarray, face: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Distance and corner weights on the triangle's plane in float64."""
        normal, edge_1, edge_2 = self._normal[face], self._edge_1[face], self._edge_2[face]
        to_plane = self._origin[face] - start
        slope = np.einsum("ij,ij->i", along, normal)
        slope = np.where(slope == 0.0, np.finfo(np.float64).tiny, slope)
        distance = np.einsum("ij,ij->i", to_plane, normal) / slope
        offset = distance[:, None] * along - to_plane
        area_2 = np.einsum("ij,ij->i", normal, normal)
        second = np.einsum("ij,ij->i", np.cross(offset, edge_2), normal) / area_2
        third = np.einsum("ij,ij->i", np.cross(edge_1, offset), normal) / area_2
        weights = np.column_stack([1.0 - second - third, second, third])
        weights = np.clip(weights, 0.0, 1.0)
        return distance, weights / weights.sum(axis=1, keepdims=True)


def _single(array: np.ndarray) -> np.ndarray:
    return np.ascontiguousarray(array, dtype=np.float32)
