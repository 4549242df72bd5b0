"""Cutting a triangle mesh by a plane: the outline, and the half on one side for a section view."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np


class Plane(NamedTuple):
    """A plane; the kept half-space is the one the normal points away from."""

    origin_mm: tuple[float, float, float]
    normal: tuple[float, float, float]


@dataclass(frozen=True, kw_only=True, slots=True)
class Clip:
    """The part of a mesh on one side of a plane, open along the cut."""

    points_mm: np.ndarray
    """Vertices [mm], shape (P, 3), float64."""
    faces: np.ndarray
    """Triangles, shape (Q, 3), int32."""
    source: np.ndarray
    """The two original vertices each vertex lies between, shape (P, 2), int64."""
    blend: np.ndarray
    """How far toward the second of them, shape (P,), float64."""

    def carry(self, values: np.ndarray) -> np.ndarray:
        """Values of the original vertices, shape (N, ...), at the vertices of the clip."""
        share = self.blend.reshape(-1, *([1] * (values.ndim - 1)))
        return (1.0 - share) * values[self.source[:, 0]] + share * values[self.source[:, 1]]


def signed_height(points_mm: np.ndarray, plane: Plane) -> np.ndarray:
    """Height of points above a plane [mm], shape (N,).

    Exact zeros are lifted by a picometre, so that every edge crosses the plane once or not at all.
    """
    normal = np.asarray(plane.normal, dtype=np.float64)
    height = (np.asarray(points_mm) - np.asarray(plane.origin_mm)) @ (
        normal / np.linalg.norm(normal)
    )
    return np.where(np.abs(height) < 1e-9, 1e-9, height)


def section_outline(points_mm: np.ndarray, faces: np.ndarray, plane: Plane) -> np.ndarray:
    """Segments in which the plane cuts the mesh [mm], shape (S, 2, 3), in no order."""
    height = signed_height(points_mm, plane)[faces]
    above = height > 0.0
    cut = np.flatnonzero(above.any(axis=1) & ~above.all(axis=1))
    corners, height, above = np.asarray(points_mm)[faces[cut]], height[cut], above[cut]
    # The corner alone on its side: both of its edges cross the plane.
    lonely = np.argmax(above == (above.sum(axis=1) == 1)[:, None], axis=1)
    row = np.arange(len(cut))
    ends = []
    for step in (1, 2):
        other = (lonely + step) % 3
        share = height[row, lonely] / (height[row, lonely] - height[row, other])
        edge = corners[row, other] - corners[row, lonely]
        ends.append(corners[row, lonely] + share[:, None] * edge)
    return np.stack(ends, axis=1) if len(cut) else np.zeros((0, 2, 3))


def half_space_clip(points_mm: np.ndarray, faces: np.ndarray, plane: Plane) -> Clip:
    """The part of a mesh below a plane (where the normal does not point).

    A crossed triangle keeps one corner (a triangle) or two (a quadrilateral, split in two).
    """
    faces = np.asarray(faces, dtype=np.int64)
    height = signed_height(points_mm, plane)
    keep = height[faces] < 0.0
    kept = keep.sum(axis=1)
    whole = np.stack([faces[kept == 3]] * 2, axis=-1)
    pieces = [whole]
    for count in (1, 2):
        rows = np.flatnonzero(kept == count)
        # Turn each triangle so that the odd corner out is its first.
        turn = np.argmax(keep[rows] == (count == 1), axis=1)
        order = (turn[:, None] + np.arange(3)) % 3
        first, second, third = np.take_along_axis(faces[rows], order, axis=1).T
        to_second, to_third = np.stack([first, second], -1), np.stack([first, third], -1)
        own = [np.stack([corner, corner], -1) for corner in (first, second, third)]
        if count == 1:
            pieces.append(np.stack([own[0], to_second, to_third], axis=1))
        else:
            pieces.append(np.stack([to_second, own[1], own[2]], axis=1))
            pieces.append(np.stack([to_second, own[2], to_third], axis=1))
    corners = np.concatenate(pieces).reshape(-1, 2)
    # The same edge met from both sides must give one vertex.
    corners = np.sort(corners, axis=1)
    source, inverse = np.unique(corners, axis=0, return_inverse=True)
    lower, upper = height[source[:, 0]], height[source[:, 1]]
    gap = np.where(lower == upper, 1.0, lower - upper)
    blend = np.where(source[:, 0] == source[:, 1], 0.0, lower / gap)
    points = np.asarray(points_mm, dtype=np.float64)
    clipped = (1.0 - blend[:, None]) * points[source[:, 0]] + blend[:, None] * points[source[:, 1]]
    return Clip(
        points_mm=clipped,
        faces=inverse.reshape(-1, 3).astype(np.int32),
        source=source,
        blend=blend,
    )
