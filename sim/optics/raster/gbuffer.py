"""What each pixel sees of the skin: face, place on it, position, normal and depth.

The skin is ray cast, exactly and with occlusion. This replaces the paper's chain of removing
occluded particles, projecting the rest and filling the depth map by cubic interpolation.

Per frame only the triangles that moved are cast. A pixel then sees the nearer of that patch and
the rest of the skin. The rest is known from the undeformed skin: it is what the pixel saw before,
or, where that has moved away, the first unmoved triangle further along the ray. The result equals
casting the whole deformed skin, at a fraction of the cost.
"""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from sim.optics.camera.camera import Rays, depth_z
from workbench.core.base.check import expect
from workbench.core.design.camera import Camera
from workbench.core.result.results import Skin

if TYPE_CHECKING:
    from geometry.surface.rays import RayCaster

MOVED_MM = 1e-3
"""Displacement below which a vertex counts as unmoved [mm]: a tenth of a grey level at most."""
STEP_PAST_MM = 1e-3
"""How far a ray steps past a triangle it has left behind [mm]; single precision holds 4e-6."""


@dataclass(frozen=True, kw_only=True, slots=True)
class GBuffer:
    """The P pixels that see a surface, and what they see. Vectors in the sensor frame."""

    pixel: np.ndarray
    """Pixel numbers, row by row, shape (P,), int64."""
    face: np.ndarray
    """Triangle, shape (P,), int32."""
    weights: np.ndarray
    """Barycentric coordinates, shape (P, 3), float32."""
    normal: np.ndarray
    """Smooth unit normals facing the camera, shape (P, 3), float32."""
    depth_z_mm: np.ndarray
    """Depth along the optical axis [mm], shape (P,), float32."""

    def take(self, rows: np.ndarray) -> GBuffer:
        """Some of the P pixels."""
        return GBuffer(
            pixel=self.pixel[rows],
            face=self.face[rows],
            weights=self.weights[rows],
            normal=self.normal[rows],
            depth_z_mm=self.depth_z_mm[rows],
        )


@dataclass(frozen=True, kw_only=True)
class View:
    """The undeformed skin seen through the fixed rays: everything frames have in common."""

    skin: Skin
    camera: Camera
    rays: Rays
    caster: RayCaster
    distance_mm: np.ndarray
    """Length of each ray to the undeformed skin [mm], shape (N,), float32; inf on a miss."""
    face: np.ndarray
    """Undeformed triangle of each pixel, shape (N,), int32; -1 on a miss."""
    area_vector_mm2: np.ndarray
    """Sum of the area vectors of each vertex's triangles [mm2], shape (V, 3), float64."""
    background: GBuffer


@dataclass(frozen=True, kw_only=True)
class Moved:
    """The part of a frame that differs from the background."""

    pixels: np.ndarray
    """Numbers of the pixels that saw or see a displaced part of the skin, shape (M,), int64."""
    seen: GBuffer
    """Those of them that see the skin now."""
    vertices: np.ndarray
    """Vertices of triangles that moved, shape (m,), int64."""
    points_mm: np.ndarray
    """All vertices of the deformed skin [mm], shape (V, 3), float64."""
    normals: np.ndarray
    """Unit outward vertex normals of the deformed skin, shape (V, 3), float64."""
    patch: RayCaster | None
    """Casts the triangles that moved; None when nothing did."""


def interpolate(values: np.ndarray, faces: np.ndarray, seen: GBuffer) -> np.ndarray:
    """Vertex values, shape (V, C), at the points seen, shape (P, C)."""
    corners = faces[seen.face]
    total = values[corners[:, 0]] * seen.weights[:, :1]
    total += values[corners[:, 1]] * seen.weights[:, 1:2]
    total += values[corners[:, 2]] * seen.weights[:, 2:]
    return total


def open_view(skin: Skin, camera: Camera, rays: Rays) -> View:
    """Cast all rays on the undeformed skin."""
    from geometry.surface.rays import RayCaster

    caster = RayCaster(skin.points_mm, skin.faces)
    distance, face, weights = caster.hits(rays.origin_mm, rays.direction)
    hit = np.flatnonzero(face >= 0)
    found = Hits(pixel=hit, distance_mm=distance[hit], face=face[hit], weights=weights[hit])
    return View(
        skin=skin,
        camera=camera,
        rays=rays,
        caster=caster,
        distance_mm=distance.astype(np.float32),
        face=face.astype(np.int32),
        area_vector_mm2=sum_area_vectors(skin.points_mm, skin.faces, len(skin.points_mm)),
        background=describe(found, skin.faces, skin.normals, camera, rays),
    )


def look(view: View, displacement_mm: np.ndarray) -> Moved:
    """What changes when the skin's vertices are displaced by (V, 3) [mm]."""
    skin = view.skin
    expect(displacement_mm, f"{len(skin.points_mm)} 3", name="displacement")
    displaced = np.einsum("ij,ij->i", displacement_mm, displacement_mm) > MOVED_MM**2
    face_moved = displaced[skin.faces].any(axis=1)
    patch_faces = np.flatnonzero(face_moved)
    points = skin.points_mm + np.where(displaced[:, None], displacement_mm, 0.0)
    vertices = _used(skin.faces[patch_faces], len(points))
    normals = _deformed_normals(view, points, patch_faces, vertices)
    patch = _patch_caster(points, skin.faces[patch_faces], vertices) if patch_faces.size else None
    pixels, found = _nearest(view, patch, patch_faces, face_moved)
    return Moved(
        pixels=pixels,
        seen=describe(found, skin.faces, normals, view.camera, view.rays),
        vertices=vertices,
        points_mm=points,
        normals=normals,
        patch=patch,
    )


@dataclass(frozen=True, kw_only=True, slots=True)
class Hits:
    """Rays that met the skin: pixel (P,), length [mm] (P,), triangle (P,), weights (P, 3)."""

    pixel: np.ndarray
    distance_mm: np.ndarray
    face: np.ndarray
    weights: np.ndarray


def describe(
    found: Hits, faces: np.ndarray, normals: np.ndarray, camera: Camera, rays: Rays
) -> GBuffer:
    """Normals and depths of what rays met, for a skin with these faces and outward normals."""
    direction = rays.direction[found.pixel]
    position = rays.origin_mm[found.pixel] + found.distance_mm[:, None] * direction
    seen = GBuffer(
        pixel=found.pixel,
        face=found.face.astype(np.int32),
        weights=found.weights.astype(np.float32),
        normal=np.zeros((0, 3), dtype=np.float32),
        depth_z_mm=depth_z(camera, position).astype(np.float32),
    )
    inward = interpolate(-normals.astype(np.float32), faces, seen)
    return dataclasses.replace(seen, normal=_face_camera(inward, direction))


def _face_camera(normal: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Unit normals with normal . direction <= 0.

    An interpolated normal can point away from a camera that sees its triangle at a grazing angle;
    it is turned until it is square to the ray, which is continuous, unlike a change of sign.
    """
    away = np.maximum(np.einsum("ij,ij->i", normal, direction), 0.0)
    normal = normal - away[:, None] * direction
    return normal / np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-12)


def _nearest(
    view: View, patch: RayCaster | None, patch_faces: np.ndarray, face_moved: np.ndarray
) -> tuple[np.ndarray, Hits]:
    """Pixels that saw or see a moved triangle, and what the rays of those pixels meet now."""
    if patch is None:
        nothing = np.zeros(0, dtype=np.int64)
        empty = np.zeros(0, dtype=np.float32)
        return nothing, Hits(
            pixel=nothing, distance_mm=empty, face=nothing, weights=np.zeros((0, 3))
        )
    distance, face, weights = patch.hits(view.rays.origin_mm, view.rays.direction)
    uncovered = np.flatnonzero((view.face >= 0) & face_moved[view.face])
    behind = _behind(view, uncovered, face_moved)
    rest = view.distance_mm.copy()
    rest[uncovered] = np.inf
    rest[behind.pixel] = behind.distance_mm
    meets_patch = distance < rest
    changed = meets_patch.copy()
    changed[uncovered] = True
    on_patch = np.flatnonzero(meets_patch)
    past = ~meets_patch[behind.pixel]
    found = Hits(
        pixel=np.concatenate([on_patch, behind.pixel[past]]),
        distance_mm=np.concatenate([distance[on_patch], behind.distance_mm[past]]),
        face=np.concatenate([patch_faces[face[on_patch]], behind.face[past]]),
        weights=np.concatenate([weights[on_patch], behind.weights[past]]),
    )
    return np.flatnonzero(changed), found


def _behind(view: View, pixels: np.ndarray, face_moved: np.ndarray) -> Hits:
    """First unmoved triangle along the rays of pixels whose undeformed triangle has moved."""
    found = []
    travelled = view.distance_mm[pixels].astype(np.float64)
    while pixels.size:
        travelled = travelled + STEP_PAST_MM
        direction = view.rays.direction[pixels]
        start = view.rays.origin_mm[pixels] + travelled[:, None] * direction
        distance, face, weights = view.caster.hits(start, direction)
        travelled = travelled + distance
        stays = (face >= 0) & ~face_moved[face]
        found.append(
            Hits(
                pixel=pixels[stays],
                distance_mm=travelled[stays].astype(np.float32),
                face=face[stays],
                weights=weights[stays],
            )
        )
        again = (face >= 0) & ~stays
        pixels, travelled = pixels[again], travelled[again]
    fields = ("pixel", "distance_mm", "face", "weights")
    if not found:
        found.append(
            Hits(pixel=pixels, distance_mm=travelled, face=pixels, weights=np.zeros((0, 3)))
        )
    return Hits(**{name: np.concatenate([getattr(h, name) for h in found]) for name in fields})


def _used(faces: np.ndarray, count: int) -> np.ndarray:
    """Vertices that occur in faces, ascending."""
    used = np.zeros(count, dtype=bool)
    used[faces.ravel()] = True
    return np.flatnonzero(used)


def _patch_caster(points: np.ndarray, faces: np.ndarray, vertices: np.ndarray) -> RayCaster:
    from geometry.surface.rays import RayCaster

    renumbered = np.zeros(len(points), dtype=np.int32)
    renumbered[vertices] = np.arange(len(vertices), dtype=np.int32)
    return RayCaster(points[vertices], renumbered[faces])


def sum_area_vectors(points: np.ndarray, faces: np.ndarray, count: int) -> np.ndarray:
    """Sum over each vertex's triangles of their area vector [mm2], shape (count, 3)."""
    first, second, third = (points[faces[:, corner]] for corner in range(3))
    area = 0.5 * np.cross(second - first, third - first)
    corners = faces.T.ravel()
    return np.column_stack(
        [np.bincount(corners, np.tile(area[:, axis], 3), minlength=count) for axis in range(3)]
    )


def _deformed_normals(
    view: View, points: np.ndarray, patch_faces: np.ndarray, vertices: np.ndarray
) -> np.ndarray:
    """Vertex normals after moving: the given normals, turned by the change of the area vectors.

    With A the sum of area vectors, n' = unit(|A| n + A' - A): equal to n where nothing moved, so
    that no seam shows, and to the usual area-weighted normal when n = A / |A|.
    """
    faces = view.skin.faces[patch_faces]
    count = len(points)
    change = sum_area_vectors(points, faces, count)
    change -= sum_area_vectors(view.skin.points_mm, faces, count)
    normals = view.skin.normals.copy()
    size = np.linalg.norm(view.area_vector_mm2[vertices], axis=1, keepdims=True)
    turned = size * normals[vertices] + change[vertices]
    normals[vertices] = turned / np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
    return normals
