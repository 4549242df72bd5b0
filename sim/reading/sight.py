"""What the pixels see of a moved skin: triangle, place on it, and light; by the renderer itself."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.raster.raster_kernels import SAME
from sim.optics.studio.render import Studio


@dataclass(frozen=True, kw_only=True, slots=True)
class Sight:
    """Of N pixels."""

    face: np.ndarray
    """Triangle, shape (N,); -1 where a pixel sees none."""
    weights: np.ndarray
    """Of its three corners, shape (N, 3)."""
    light: np.ndarray
    """Radiance behind the cavity's wall, shape (N, 3), float32."""

    def blended(self, values: np.ndarray, faces: np.ndarray, pixels: np.ndarray) -> np.ndarray:
        """Values at vertices, (V, C), where pixels (P,) look, shape (P, C).

        Without meaning where they see no skin.
        """
        corners, weights = faces[np.maximum(self.face[pixels], 0)], self.weights[pixels]
        found = weights[:, :1] * values[corners[:, 0]]
        for corner in (1, 2):
            found += weights[:, corner, None] * values[corners[:, corner]]
        return found


def at_rest(studio: Studio) -> Sight:
    """The skin that nothing touches."""
    view = studio.imager.raster.view
    first, sees = view.layer_start[:-1], np.diff(view.layer_start) > 0
    face = np.full(len(sees), -1)
    weights = np.zeros((len(sees), 3))
    face[sees] = view.layer_face[first[sees]]
    weights[sees] = view.layer_weights[first[sees]]
    still = np.zeros((1, len(view.points_mm), 3), dtype=np.float32)
    return Sight(face=face, weights=weights, light=studio.linear(still)[0].reshape(-1, 3))


def moved(studio: Studio, rest: Sight, displacement_mm: np.ndarray) -> Sight:
    """The skin displaced by (V, 3) [mm].

    Args:
        studio: The camera and its light.
        rest: What it sees at rest.
        displacement_mm: Of the vertices of the seen skin.
    """
    light = studio.linear(displacement_mm[None].astype(np.float32))[0].reshape(-1, 3)
    return latest(studio, rest, light)


def latest(studio: Studio, rest: Sight, light: np.ndarray) -> Sight:
    """The skin as the studio drew it last.

    Args:
        studio: The camera and its light.
        rest: What it sees at rest.
        light: Radiance of the pixels then, shape (N, 3).
    """
    raster = studio.imager.raster
    found = raster.seen.triangle.to_numpy()[: raster.pixels]
    changed = np.flatnonzero(found != SAME)
    later = raster.seen.weights.to_numpy()[changed]
    face, weights = rest.face.copy(), rest.weights.copy()
    face[changed] = found[changed]
    weights[changed] = np.column_stack([1.0 - later.sum(axis=1), later])
    return Sight(face=face, weights=weights, light=light)
