"""What a camera shows of a skin whose displacement is known: a photograph, and the truth below it.

The displacement may have any direction. What a photograph can tell of it is how far the surface has
moved, not where its points went: a skin that slides along itself looks the same. So the depth of a
displaced vertex is its distance from the surface at rest, and that of a place at rest is the
distance of the displaced surface from it, both along normals at rest, to the second order of the
spacing of the vertices over the radius of the skin.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.studio.render import Studio
from sim.reading.rest_skin import RestSkin, normals_of, open_rest_skin
from sim.reading.sight import Sight, at_rest, latest

MOVED_MM = 5e-3
"""Displacement below which a vertex rests: a tenth of what counts as touched."""
TURNED = 5e-3
"""Change of a normal below which it is at rest: a third of a degree."""
AROUND = 4
"""Displaced vertices from which the surface over a place at rest is interpolated."""
NEAR_MM = 1e-3
"""Added to distances before they weigh."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ShownPress:
    """Of an image of H x W pixels; 0 where nothing moved."""

    photo: np.ndarray
    """Grey levels, shape (H, W, 3), uint8."""
    depth_mm: np.ndarray
    """Inward displacement of the surface that a pixel sees, (H, W), float32; NaN without skin."""
    surface_mm: np.ndarray
    """The same over the place that it saw at rest, shape (H, W), float32."""
    turn: np.ndarray
    """Change of the inward unit normal, shape (H, W, 3), float32."""
    pressure_MPa: np.ndarray
    """Contact pressure of the skin that it sees, shape (H, W), float32."""


class PressCamera:
    """One camera that shows presses of one skin."""

    def __init__(self, studio: Studio) -> None:
        from scipy.spatial import KDTree

        self.studio = studio
        self.skin: RestSkin = open_rest_skin(studio.imager.raster.view)
        self.sight: Sight = at_rest(studio)
        through = studio.imager.raster.view.transmittance
        self.sees: np.ndarray = (self.sight.face >= 0) & (through > 0.0)
        """Pixels that see skin at rest, shape (N,), bool."""
        still = np.zeros((1, self.skin.count, 3), dtype=np.float32)
        self.idle: np.ndarray = studio.images(still)[0]
        """The photograph at rest, shape (H, W, 3), uint8."""
        normals = self._shown(self.sight, self.skin.inward, self.sees)
        self.normals: np.ndarray = _unit(normals)
        """Inward unit normals at rest, shape (H, W, 3), float32; 0 without skin."""
        self._tree = KDTree(self.skin.points_mm)

    def show(self, displacement_mm: np.ndarray, pressure_MPa: np.ndarray) -> ShownPress:
        """Show a press.

        Args:
            displacement_mm: Of the vertices, shape (V, 3).
            pressure_MPa: At the vertices, shape (V,).
        """
        moved_mm = displacement_mm.astype(np.float32)
        photo = self.studio.images(moved_mm[None])[0]
        sight = latest(self.studio, self.sight, self.sight.light)
        depth_mm, surface_mm = self._depths(displacement_mm)
        normal = normals_of(self.skin, displacement_mm)
        sees = self.sees & (sight.face >= 0)
        found = self._shown(
            sight, np.column_stack([depth_mm, pressure_MPa, normal]), sees, fill=np.nan
        )
        turn = np.nan_to_num(_unit(found[:, :, 2:]) - self.normals)
        turn[np.abs(turn).max(axis=2) < TURNED] = 0.0
        return ShownPress(
            photo=photo,
            depth_mm=found[:, :, 0],
            surface_mm=self._shown(self.sight, surface_mm[:, None], self.sees)[:, :, 0],
            turn=turn.astype(np.float32),
            pressure_MPa=np.nan_to_num(found[:, :, 1]),
        )

    def _depths(self, displacement_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Of the displaced vertices, and of the surface over the vertices at rest [mm], (V,)."""
        from scipy.spatial import KDTree

        skin = self.skin
        depth_mm, surface_mm = np.zeros(skin.count), np.zeros(skin.count)
        moved = np.flatnonzero(np.linalg.norm(displacement_mm, axis=1) > MOVED_MM)
        if not len(moved):
            return depth_mm, surface_mm
        places = skin.points_mm[moved] + displacement_mm[moved]
        depth_mm[moved] = np.einsum("nc,nc->n", displacement_mm[moved], skin.inward[moved])
        for _ in range(2):
            # The foot of a displaced vertex on the skin at rest, and its distance from there.
            foot = places - depth_mm[moved, None] * skin.inward[moved]
            _, nearest = self._tree.query(foot)
            away = places - skin.points_mm[nearest]
            depth_mm[moved] = np.einsum("nc,nc->n", away, skin.inward[nearest])
        foot = places - depth_mm[moved, None] * skin.inward[nearest]
        reach_mm = float(np.linalg.norm(displacement_mm[moved], axis=1).max())
        around, _ = KDTree(foot).query(skin.points_mm, distance_upper_bound=reach_mm + MOVED_MM)
        near = np.flatnonzero(np.isfinite(around))
        feet = np.concatenate([foot, np.delete(skin.points_mm, moved, axis=0)])
        depths = np.concatenate([depth_mm[moved], np.zeros(skin.count - len(moved))])
        away_mm, chosen = KDTree(feet).query(skin.points_mm[near], k=AROUND)
        weight = 1.0 / (away_mm + NEAR_MM) ** 2
        surface_mm[near] = (weight * depths[chosen]).sum(axis=1) / weight.sum(axis=1)
        return depth_mm, surface_mm

    def _shown(
        self, sight: Sight, values: np.ndarray, sees: np.ndarray, *, fill: float = 0.0
    ) -> np.ndarray:
        """Values at vertices, (V, C), as pixels see them, shape (H, W, C), float32."""
        rows, columns = self.studio.imager.shape
        found = np.full((rows * columns, values.shape[1]), fill, dtype=np.float32)
        pixels = np.flatnonzero(sees)
        found[pixels] = sight.blended(values, self.skin.faces, pixels)
        return found.reshape(rows, columns, -1)


def _unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors (..., 3) of length 1; 0 stays 0."""
    return vectors / np.maximum(np.linalg.norm(vectors, axis=-1, keepdims=True), 1e-6)
