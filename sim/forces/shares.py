"""Where points lie on a skin, and what its vertices say there or are given.

Values per vertex are interpolated at the nearest point of the skin. Forces are shared out instead:
each goes to the corners of the triangle that is nearest to where it acts, in shares that keep it
there. Fields that are not known have no frames, and keep none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.surface import closest_point
from workbench.core.result.results import Skin

LEAST = 1e-12


@dataclass(frozen=True, kw_only=True, slots=True)
class Shares:
    """Corners and barycentric shares of the points of one skin nearest to places."""

    corners: np.ndarray
    """Vertices, shape (N, 3)."""
    weights: np.ndarray
    """Their shares, shape (N, 3), sum 1."""

    def interpolate(self, values: np.ndarray) -> np.ndarray:
        """Values of the skin's vertices (K, V, ...) at the places, (K, N, ...)."""
        if not len(values):
            return values
        shape = (1, *self.weights.shape, *(1,) * (values.ndim - 2))
        found = (values[:, self.corners] * self.weights.reshape(shape)).sum(axis=2)
        return found.astype(values.dtype)

    def nearest(self, values: np.ndarray) -> np.ndarray:
        """Values of the nearest vertices, (K, V, ...) to (K, N, ...)."""
        if not len(values):
            return values
        rows = np.arange(len(self.corners))
        return values[:, self.corners[rows, self.weights.argmax(axis=1)]]

    def spread(self, forces: np.ndarray, count: int) -> np.ndarray:
        """Forces at the places (K, N, 3) shared out to the skin's vertices, (K, count, 3)."""
        found = np.zeros((len(forces), count, 3), np.float64)
        for frame, force in enumerate(forces):
            acting = np.flatnonzero(force.any(axis=1))
            for corner in range(3):
                share = self.weights[acting, corner, None] * force[acting]
                np.add.at(found[frame], self.corners[acting, corner], share)
        return found.astype(np.float32)


def shares_on(skin: Skin, places_mm: np.ndarray) -> Shares:
    """Where places (N, 3) lie on a skin."""
    points, _, faces = closest_point(skin.points_mm, skin.faces, places_mm)
    corners = skin.faces[faces]
    return Shares(corners=corners, weights=barycentric(skin.points_mm[corners], points))


def barycentric(corners_mm: np.ndarray, points_mm: np.ndarray) -> np.ndarray:
    """Barycentric coordinates of points (N, 3) of triangles (N, 3, 3), shape (N, 3).

    Source: Ericson, Real-Time Collision Detection, section 3.4.
    """
    a, b, c = corners_mm[:, 0], corners_mm[:, 1], corners_mm[:, 2]
    along, across, place = b - a, c - a, points_mm - a
    aa, ab, bb = (np.einsum("ni,ni->n", x, y) for x, y in
                  ((along, along), (along, across), (across, across)))  # fmt: skip
    pa, pb = np.einsum("ni,ni->n", place, along), np.einsum("ni,ni->n", place, across)
    below = np.maximum(aa * bb - ab * ab, LEAST)
    second, third = (bb * pa - ab * pb) / below, (aa * pb - ab * pa) / below
    found = np.clip(np.stack([1.0 - second - third, second, third], axis=1), 0.0, 1.0)
    return found / found.sum(axis=1, keepdims=True)
