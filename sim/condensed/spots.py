"""Where contact is looked at: spots in the triangles around each node, six on a regular skin."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.surface import face_areas


@dataclass(frozen=True, kw_only=True, slots=True)
class Spots:
    """Spots by node."""

    starts: np.ndarray
    """First spot of each of the N nodes, then S: shape (N + 1,), int32."""
    others: np.ndarray
    """The two other corners of the triangle a spot lies in, shape (S, 2), int32."""
    areas_mm2: np.ndarray
    """A third of that triangle, shape (S,)."""

    @property
    def most(self) -> int:
        """Spots of a node at most."""
        return int(np.diff(self.starts).max())


def spots_of(points_mm: np.ndarray, faces: np.ndarray) -> Spots:
    """Spots of a skin: each triangle has one near each of its corners."""
    own = faces.ravel()
    others = np.stack([np.roll(faces, -1, axis=1), np.roll(faces, -2, axis=1)], axis=2)
    order = np.argsort(own, kind="stable")
    counts = np.bincount(own, minlength=len(points_mm))
    return Spots(
        starts=np.append(0, np.cumsum(counts)).astype(np.int32),
        others=others.reshape(-1, 2)[order].astype(np.int32),
        areas_mm2=np.repeat(face_areas(points_mm, faces) / 3.0, 3)[order],
    )
