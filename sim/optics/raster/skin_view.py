"""The undeformed skin through the camera's rays: all that frames of one design have in common.

Plain arrays, found once on the CPU with exact ray casting; `raster` takes them to the device. A
pixel's layers are all triangles along its ray, nearest first: where the first moves away, the next
one that stayed is what the pixel sees.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.camera.camera import Rays
from sim.optics.camera.projection import FOUND_MM, NO_PIXEL, RayMap, open_map, project_points, seeds
from sim.optics.camera.walls import STEP_PAST_MM
from sim.optics.raster.gbuffer import sum_area_vectors
from sim.optics.raster.tree import order_of_faces
from workbench.core.design.camera import Camera
from workbench.core.result.results import MembraneMesh, Skin

MOST_LAYERS = 8
"""Triangles kept along a ray; behind eight walls of skin nothing is lit."""
HIDDEN_MM = 0.05
"""How much nearer another part of the skin must be to hide a vertex [mm]: a tenth of an edge."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SkinView:
    """V vertices, F faces in the order of the tree, N pixels."""

    points_mm: np.ndarray
    """Shape (V, 3), float32."""
    normals: np.ndarray
    """Outward unit normals, shape (V, 3), float32."""
    area_mm2: np.ndarray
    """Sum of the area vectors of each vertex's faces, shape (V, 3), float32."""
    faces: np.ndarray
    """Shape (F, 3), int32."""
    face_number: np.ndarray
    """Number of each face in the mesh, shape (F,), int32."""
    face_start: np.ndarray
    """Where each vertex's faces begin in `face_of`, shape (V + 1,), int32."""
    face_of: np.ndarray
    """Faces of the vertices, shape (3 F,), int32."""
    foot_map: np.ndarray
    """`RayMap.foot_mm`."""
    way_map: np.ndarray
    """`RayMap.direction`."""
    pad_px: int
    start_pixel: np.ndarray
    """Map coordinates of each vertex, or where on the map's border it is nearest, (V, 2)."""
    projects: np.ndarray
    """Whether a ray of the map passes through the vertex, shape (V,), bool."""
    range_mm: np.ndarray
    """Length of the line of sight to each vertex [mm], shape (V,), float32."""
    to_camera: np.ndarray
    """Unit direction from each vertex along its ray to the camera, shape (V, 3), float32."""
    visible: np.ndarray
    """Vertices that the camera sees, shape (V,), bool."""
    origin_mm: np.ndarray
    """`Rays.origin_mm`, shape (N, 3), float32."""
    direction: np.ndarray
    """`Rays.direction`, shape (N, 3), float32."""
    transmittance: np.ndarray
    """Shape (N,), float32."""
    travelled_mm: np.ndarray
    """Length of the line of sight before the ray's origin [mm], shape (N,), float32."""
    folded: np.ndarray
    """Pixels whose rays must be cast in each frame, shape (N,), uint8."""
    layer_start: np.ndarray
    """Where each pixel's layers begin, shape (N + 1,), int32."""
    layer_face: np.ndarray
    """Their faces, int32."""
    layer_mm: np.ndarray
    """Their distances from the ray's origin [mm], float32."""
    layer_weights: np.ndarray
    """Weights of their three corners, shape (-1, 3), float32."""
    seen_start: np.ndarray
    """Where each face's pixels begin in `seen_pixel`, shape (F + 1,), int32."""
    seen_pixel: np.ndarray
    """Pixels whose first layer is the face, int32."""
    width_px: int
    height_px: int

    @property
    def rays(self) -> Rays:
        """The rays of the image's pixels."""
        return Rays(
            origin_mm=self.origin_mm,
            direction=self.direction,
            transmittance=self.transmittance,
            width_px=self.width_px,
            height_px=self.height_px,
        )


def open_skin_view(mesh: MembraneMesh, camera: Camera, *, index: float) -> SkinView:
    """Cast and project everything once.

    Args:
        mesh: The undeformed skins.
        camera: Inside the cavity.
        index: Refractive index of support and elastomer [1].
    """
    skin = mesh.seen
    ray_map = open_map(mesh, camera, index=index)
    order = order_of_faces(skin.points_mm, skin.faces)
    faces = np.ascontiguousarray(skin.faces[order], dtype=np.int32)
    layers = _layers(skin.points_mm, faces, ray_map.rays)
    first = layers.first
    pixels = np.flatnonzero(first >= 0)
    by_face = np.argsort(first[pixels], kind="stable")
    corners = np.argsort(faces.ravel(), kind="stable")
    start_pixel, projects, to_camera, range_mm, visible = _vertices(skin, camera, ray_map)
    return SkinView(
        points_mm=skin.points_mm.astype(np.float32),
        normals=skin.normals.astype(np.float32),
        area_mm2=sum_area_vectors(skin.points_mm, faces, len(skin.points_mm)).astype(np.float32),
        faces=faces,
        face_number=order,
        face_start=_starts(faces.ravel(), len(skin.points_mm)),
        face_of=(corners // 3).astype(np.int32),
        foot_map=ray_map.foot_mm,
        way_map=ray_map.direction,
        pad_px=ray_map.pad_px,
        start_pixel=start_pixel,
        projects=projects,
        range_mm=range_mm,
        to_camera=to_camera,
        visible=visible,
        origin_mm=ray_map.rays.origin_mm,
        direction=ray_map.rays.direction,
        transmittance=ray_map.rays.transmittance,
        travelled_mm=ray_map.travelled_mm,
        folded=ray_map.folded.astype(np.uint8),
        layer_start=layers.start,
        layer_face=layers.face,
        layer_mm=layers.distance_mm,
        layer_weights=layers.weights,
        seen_start=_starts(first[pixels], len(faces)),
        seen_pixel=pixels[by_face].astype(np.int32),
        width_px=camera.width_px,
        height_px=camera.height_px,
    )


def _starts(numbers: np.ndarray, count: int) -> np.ndarray:
    """Where each of `count` numbers begins in their sorted list, shape (count + 1,), int32."""
    return np.append(0, np.cumsum(np.bincount(numbers, minlength=count))).astype(np.int32)


@dataclass(frozen=True, kw_only=True, slots=True)
class _Layers:
    start: np.ndarray
    face: np.ndarray
    distance_mm: np.ndarray
    weights: np.ndarray
    first: np.ndarray


def _layers(points: np.ndarray, faces: np.ndarray, rays: Rays) -> _Layers:
    """All triangles along each ray, nearest first."""
    from geometry.surface.rays import RayCaster

    caster = RayCaster(points, faces)
    pixel = np.arange(len(rays.direction))
    travelled = np.zeros(len(pixel))
    found: list[tuple[np.ndarray, ...]] = []
    first = np.full(len(pixel), -1, dtype=np.int64)
    for number in range(MOST_LAYERS):
        direction = rays.direction[pixel]
        start = rays.origin_mm[pixel] + travelled[:, None] * direction
        distance, face, weights = caster.hits(start, direction)
        met = face >= 0
        pixel, face, weights = pixel[met], face[met], weights[met]
        travelled = travelled[met] + distance[met]
        found.append((pixel, face, travelled.astype(np.float32), weights.astype(np.float32)))
        if number == 0:
            first[pixel] = face
        travelled = travelled + STEP_PAST_MM
        if not pixel.size:
            break
    pixels, hit, distances, shares = (np.concatenate(part) for part in zip(*found, strict=True))
    order = np.argsort(pixels, kind="stable")
    return _Layers(
        start=_starts(pixels, len(rays.direction)),
        face=hit[order].astype(np.int32),
        distance_mm=distances[order],
        weights=shares[order],
        first=first,
    )


def _vertices(
    skin: Skin, camera: Camera, ray_map: RayMap
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Map coordinates, whether they hold, directions to the camera, ranges and visibility."""
    from geometry.surface.rays import RayCaster

    points = skin.points_mm
    spots = project_points(ray_map, points, seeds(ray_map, points))
    met = spots.miss_mm < FOUND_MM
    line = np.asarray(camera.position_mm) - points
    line /= np.maximum(np.linalg.norm(line, axis=1, keepdims=True), 1e-12)
    to_camera = np.where(met[:, None], -spots.direction, line)
    uv = spots.xy + 0.5 - ray_map.pad_px
    inside = met & (uv >= 0.0).all(axis=1)
    inside &= (uv[:, 0] <= camera.width_px) & (uv[:, 1] <= camera.height_px)
    looked = np.flatnonzero(inside)
    cell = np.clip(uv[looked].astype(np.int64), 0, [camera.width_px - 1, camera.height_px - 1])
    pixel = cell[:, 1] * camera.width_px + cell[:, 0]
    # Backward along the ray as far as its pixel's ray is long: what lies between hides the vertex.
    start = points[looked] + HIDDEN_MM * to_camera[looked]
    reach = np.linalg.norm(points[looked] - ray_map.rays.origin_mm[pixel], axis=1) - HIDDEN_MM
    blocked = RayCaster(points, skin.faces).occluded(start, to_camera[looked], reach)
    passes = ray_map.rays.transmittance[pixel] > 0.0
    visible = np.zeros(len(points), dtype=bool)
    visible[looked] = ~blocked & passes
    highest = np.array(ray_map.lead_mm.shape[::-1]) - 1.0
    on_border = ((spots.xy <= 0.0) | (spots.xy >= highest)).any(axis=1)
    start_pixel = np.where((met | on_border)[:, None], spots.xy, NO_PIXEL).astype(np.float32)
    return (
        start_pixel,
        met,
        to_camera.astype(np.float32),
        spots.range_mm.astype(np.float32),
        visible,
    )
