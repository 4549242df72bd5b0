"""Which point of the skin a pixel sees, and which pixel sees a point of the skin.

A pixel's ray leaves the camera, is bent where it enters the clear support through the cavity wall,
and ends on the deformed skin: the way of `sim.optics.camera.camera.refracted_rays`, for single
pixels. The way back has no closed form. A pixel u is sought whose bent ray passes the point p, by
Newton's method on the miss of the ray at its nearest approach,

    m(u) = (p - o) - ((p - o) . d) d,      u <- u - J^+ m,

with o, d the ray inside the support and J by differences of half a pixel, from the pixel that the
point would have without refraction. Coordinates are those of `sim.optics.camera.camera`: the centre
of pixel (column, row) is (column + 0.5, row + 0.5).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core.design.camera import Camera
from workbench.core.design.optics import Optics
from workbench.core.result.results import MembraneMesh, Skin
from workbench.core.result.sensing import Contact
from workbench.view.scene_shapes import first_hit

HALF_PX = 0.5
STEPS = 20
"""Newton steps at most; four are usual."""
LONGEST_STEP_PX = 40.0
"""A step longer than this leaves the place where the differences hold [px]."""
CLOSE_MM = 1e-4
"""A ray that passes a point so near sees it [mm]."""
HIDDEN_MM = 0.05
"""Skin that a ray meets so much before a point hides it [mm]."""
LEAST_MM = 1e-3
"""Rays start so far behind the wall they entered by [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SkinPoint:
    """A place on the skin that a camera looks at, in one frame."""

    place_mm: np.ndarray
    """Where it is, deformed [mm], shape (3,)."""
    face: int
    weights: np.ndarray
    """Barycentric coordinates in its triangle, shape (3,)."""

    def value(self, skin: Skin, values: np.ndarray) -> np.ndarray:
        """Values of the skin's vertices, shape (V, ...), at the place, shape (...)."""
        return np.tensordot(self.weights, np.asarray(values)[skin.faces[self.face]], axes=1)


@dataclass(frozen=True, kw_only=True, slots=True)
class PixelFound:
    """A pixel that looks at a place, or why none does."""

    uv_px: np.ndarray
    """Column and row [px], shape (2,); NaN without one."""
    why: str = ""
    """Why the place is not in the image; empty where it is."""


class PixelLink:
    """One camera and the skin it sees, in one frame of a press."""

    def __init__(
        self, mesh: MembraneMesh, optics: Optics, camera: Camera, displacement_mm: np.ndarray
    ) -> None:
        """Take a frame.

        Args:
            mesh: The membrane and the cavity wall.
            optics: For the refractive index.
            camera: The camera.
            displacement_mm: Of the vertices of `mesh.seen` [mm], shape (V, 3).
        """
        self.skin = mesh.seen
        self.points_mm = np.asarray(self.skin.points_mm) + np.asarray(displacement_mm)
        self.camera = camera
        self._cavity = mesh.cavity
        self._index = optics.refractive_index

    def ray(self, uv_px: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Start [mm] and unit direction of a pixel's ray inside the support, each shape (3,)."""
        from sim.optics.camera.camera import pixel_directions
        from sim.optics.camera.refraction import refract

        origin = np.asarray(self.camera.position_mm, dtype=np.float64)
        direction = pixel_directions(self.camera, np.asarray(uv_px, dtype=np.float64)[None])[0]
        wall = self._cavity
        if self._index == 1.0:
            return origin, direction
        met = first_hit(wall.points_mm, wall.faces, origin, direction, both_sides=True)
        if met is None:
            return origin, direction
        corners = wall.faces[met[0]]
        weights = barycentric(met[1], np.asarray(wall.points_mm)[corners])
        normal = weights @ wall.normals[corners]
        normal /= np.linalg.norm(normal)
        bent, _ = refract(direction[None], normal[None], index_from=1.0, index_to=self._index)
        return met[1], bent[0]

    def skin_at(self, uv_px: np.ndarray) -> SkinPoint | None:
        """The place of the skin that a pixel coordinate sees; None where it sees none."""
        origin, direction = self.ray(uv_px)
        start = origin + LEAST_MM * direction
        met = first_hit(self.points_mm, self.skin.faces, start, direction, both_sides=True)
        return None if met is None else self._point(*met)

    def _point(self, face: int, place_mm: np.ndarray) -> SkinPoint:
        corners = self.points_mm[self.skin.faces[face]]
        return SkinPoint(place_mm=place_mm, face=face, weights=barycentric(place_mm, corners))

    def nearest(self, place_mm: np.ndarray) -> SkinPoint:
        """The place of the seen skin next to a point [mm]: of a skin that is seen from within."""
        from geometry.surface.surface import closest_point

        found, _, faces = closest_point(
            self.points_mm, self.skin.faces, np.asarray(place_mm, dtype=np.float64)[None]
        )
        return self._point(int(faces[0]), found[0])

    def mm_per_px(self, uv_px: np.ndarray) -> tuple[float, float]:
        """Size of a pixel on the skin along columns and rows [mm]; NaN at the edge of sight."""
        sizes = []
        for step in (np.array([HALF_PX, 0.0]), np.array([0.0, HALF_PX])):
            ends = [self.skin_at(np.asarray(uv_px) + side * step) for side in (-1.0, 1.0)]
            first, last = ends
            known = first is not None and last is not None
            sizes.append(
                float(np.linalg.norm(last.place_mm - first.place_mm)) if known else float("nan")  # pyright: ignore[reportOptionalMemberAccess]
            )
        return sizes[0], sizes[1]

    def pixel_of(self, place_mm: np.ndarray) -> PixelFound:
        """The pixel coordinate that sees a place of the skin."""
        from sim.optics.camera.camera import project

        place = np.asarray(place_mm, dtype=np.float64)
        uv = project(self.camera, place[None])[0]
        nowhere = np.full(2, np.nan)
        if not np.isfinite(uv).all():
            return PixelFound(uv_px=nowhere, why="it lies behind the camera")
        for _ in range(STEPS):
            miss = self._miss(uv, place)
            if np.linalg.norm(miss) < CLOSE_MM:
                break
            slopes = [
                (self._miss(uv + step, place) - self._miss(uv - step, place)) / (2 * HALF_PX)
                for step in (np.array([HALF_PX, 0.0]), np.array([0.0, HALF_PX]))
            ]
            way = np.linalg.lstsq(np.stack(slopes, axis=1), miss, rcond=None)[0]
            length = float(np.linalg.norm(way))
            uv = uv - way * min(1.0, LONGEST_STEP_PX / max(length, 1e-12))
        if np.linalg.norm(self._miss(uv, place)) > 10 * CLOSE_MM:
            return PixelFound(uv_px=nowhere, why="no ray of this camera gets there")
        size = np.array([self.camera.width_px, self.camera.height_px])
        if (uv < 0.0).any() or (uv > size).any():
            return PixelFound(uv_px=nowhere, why="it lies outside the image")
        seen = self.skin_at(uv)
        origin, direction = self.ray(uv)
        if seen is not None and (place - seen.place_mm) @ direction > HIDDEN_MM:
            return PixelFound(uv_px=nowhere, why="other skin hides it from this camera")
        if (place - origin) @ direction < 0.0:
            return PixelFound(uv_px=nowhere, why="it lies behind the camera")
        return PixelFound(uv_px=uv)

    def _miss(self, uv_px: np.ndarray, place_mm: np.ndarray) -> np.ndarray:
        """By how much the ray of a pixel coordinate passes a place [mm], shape (3,)."""
        origin, direction = self.ray(uv_px)
        offset = place_mm - origin
        return offset - (offset @ direction) * direction


def barycentric(place: np.ndarray, corners: np.ndarray) -> np.ndarray:
    """Weights of the corners (3, 3) of a triangle at a place in its plane, shape (3,)."""
    edges = np.stack([corners[1] - corners[0], corners[2] - corners[0]], axis=1)
    v, w = np.linalg.lstsq(edges, place - corners[0], rcond=None)[0]
    return np.array([1.0 - v - w, v, w])


def frame_link(
    mesh: MembraneMesh, optics: Optics, number: int, contact: Contact | None, frame: int
) -> PixelLink:
    """Camera `number`, from 0, in frame `frame` of a press, 0 for the skin at rest."""
    count = len(mesh.seen.points_mm)
    moved = np.zeros((count, 3))
    if contact is not None and 0 < frame <= len(contact.reaction_N):
        found = mesh.seen_displacement_mm(contact)[frame - 1]
        if len(found) == count:
            moved = np.asarray(found)
    return PixelLink(mesh, optics, optics.all_cameras[number], moved)
