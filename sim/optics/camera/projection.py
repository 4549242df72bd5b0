"""From a point of the skin to its pixel, through a refracting wall that has no formula.

`RayMap` holds the refracted ray of every pixel of a grid that is wider than the image. The pixel
of a point is where the line between the grid's rays passes through it: with foot o(x, y) and
direction d(x, y) bilinear between pixels, Gauss-Newton on the perpendicular distance

    r = q - (q . d) d,  q = P - o;   J = [perp(o_x + s d_x), perp(o_y + s d_y)],  s = q . d

finds x, y in two or three steps from a neighbouring pixel. The foot is the point of the line
nearest to the camera: it changes smoothly even where the wall is met at grazing incidence.

A ridge towards the camera can show one point of the skin in several pixels. Those pixels are
`folded`: no point may be projected there, and rays are cast instead.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.optics.camera.camera import Rays, focal_px, pixel_directions
from sim.optics.camera.folds import folds, spread
from sim.optics.camera.walls import Segments, last_segments
from workbench.core.design.camera import Camera
from workbench.core.result.results import MembraneMesh, Skin

LEAST_PAD_PX = 8
LARGEST_PAD = 0.25
"""Widest border of the map, as a share of the image's width [1]."""
NEWTON_STEPS = 10
LARGEST_STEP = 0.1
"""Longest step, as a share of the map's width [1]: across a fold a step may point anywhere."""
NO_PIXEL = -1.0
"""Map coordinate of a point that no ray of the map passes through."""
FOUND_MM = 0.02
"""Distance from a ray below which a point counts as lying on it [mm]: a twentieth of an edge."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RayMap:
    """Rays on a grid of pixel centres: column i of the map is column i - pad of the image."""

    camera: Camera
    pad_px: int
    foot_mm: np.ndarray
    """Point of each ray nearest to the camera [mm], shape (H + 2 pad, W + 2 pad, 3), float32."""
    direction: np.ndarray
    """Unit directions away from the camera, same shape, float32."""
    lead_mm: np.ndarray
    """Length of the line of sight from the camera to the foot [mm], (H + 2 pad, W + 2 pad)."""
    rays: Rays
    """The rays of the image's own pixels."""
    travelled_mm: np.ndarray
    """Length of the line of sight before the rays' origins [mm], shape (H * W,), float32."""
    hit_mm: np.ndarray
    """Where each ray meets the undeformed skin [mm], (H + 2 pad, W + 2 pad, 3), float32; NaN."""
    folded: np.ndarray
    """Pixels of the image whose rays must be cast, shape (H * W,), bool."""


def open_map(mesh: MembraneMesh, camera: Camera, *, index: float) -> RayMap:
    """The ray map of one camera; constant for a design."""
    pad = _pad_px(mesh.seen, camera)
    columns = np.arange(-pad, camera.width_px + pad) + 0.5
    rows = np.arange(-pad, camera.height_px + pad) + 0.5
    grid = np.stack(np.meshgrid(columns, rows), axis=-1)
    place = np.asarray(camera.position_mm, dtype=np.float64)
    segments = last_segments(
        pixel_directions(camera, grid.reshape(-1, 2)),
        place,
        cavity=mesh.cavity,
        seen=mesh.seen,
        index=index,
    )
    shape = grid.shape[:2]
    along = np.einsum("ij,ij->i", place - segments.origin_mm, segments.direction)
    foot = segments.origin_mm + along[:, None] * segments.direction
    hit, face = _meet(mesh.seen, segments)
    inner = (slice(pad, pad + camera.height_px), slice(pad, pad + camera.width_px))

    def image(values: np.ndarray) -> np.ndarray:
        cropped = values.reshape(*shape, -1)[inner]
        return np.ascontiguousarray(cropped.reshape(-1, cropped.shape[2]), dtype=np.float32)

    rays = Rays(
        origin_mm=image(segments.origin_mm),
        direction=image(segments.direction),
        transmittance=image(segments.transmittance)[:, 0],
        width_px=camera.width_px,
        height_px=camera.height_px,
    )
    bad = folds(
        hit.reshape(*shape, 3),
        segments.direction.reshape(*shape, 3),
        foot.reshape(*shape, 3) - place,
        segments.walls.reshape(shape),
    )
    folded = spread(bad, face.reshape(shape), mesh.seen.faces)
    return RayMap(
        camera=camera,
        pad_px=pad,
        foot_mm=foot.reshape(*shape, 3).astype(np.float32),
        direction=segments.direction.reshape(*shape, 3).astype(np.float32),
        lead_mm=(segments.travelled_mm + along).reshape(shape).astype(np.float32),
        rays=rays,
        travelled_mm=image(segments.travelled_mm)[:, 0],
        hit_mm=hit.reshape(*shape, 3).astype(np.float32),
        folded=folded[inner].ravel(),
    )


def _pad_px(seen: Skin, camera: Camera) -> int:
    """A border wider than two triangles, wherever they are seen."""
    corners = seen.points_mm[seen.faces]
    longest = np.sqrt(((corners - np.roll(corners, 1, axis=1)) ** 2).sum(axis=2).max())
    nearest = np.linalg.norm(seen.points_mm - np.asarray(camera.position_mm), axis=1).min()
    wanted = math.ceil(2.0 * longest / max(nearest, longest) * focal_px(camera))
    widest = max(LEAST_PAD_PX, int(LARGEST_PAD * camera.width_px))
    return min(max(wanted, LEAST_PAD_PX), widest)


def _meet(seen: Skin, segments: Segments) -> tuple[np.ndarray, np.ndarray]:
    """Where rays meet the skin [mm], (N, 3), NaN where they miss; and in which triangle."""
    from geometry.surface.rays import RayCaster

    caster = RayCaster(seen.points_mm, seen.faces)
    distance, face, _ = caster.hits(segments.origin_mm, segments.direction)
    distance[face < 0] = np.nan
    return segments.origin_mm + distance[:, None] * segments.direction, face


@dataclass(frozen=True, kw_only=True, slots=True)
class Projected:
    """N points in map coordinates."""

    xy: np.ndarray
    """Column and row in the map, 0 at its first pixel's centre, shape (N, 2), float64."""
    miss_mm: np.ndarray
    """Distance of the point from the ray there [mm], shape (N,), float64."""
    direction: np.ndarray
    """Unit direction of that ray, shape (N, 3), float64."""
    range_mm: np.ndarray
    """Length of the line of sight [mm], shape (N,), float64."""


def project_points(
    ray_map: RayMap, points_mm: np.ndarray, xy: np.ndarray, *, steps: int = NEWTON_STEPS
) -> Projected:
    """Pixels of points (N, 3) [mm] by Gauss-Newton from map coordinates (N, 2); the plain twin of
    `projection_kernels.project`."""
    highest = np.array(ray_map.lead_mm.shape[::-1]) - 1.0
    xy = np.clip(np.asarray(xy, dtype=np.float64), 0.0, highest)
    for _ in range(steps):
        miss, along_x, along_y, _, _ = _residual(ray_map, points_mm, xy)
        xx, yy = _dot(along_x, along_x), _dot(along_y, along_y)
        cross = _dot(along_x, along_y)
        right_x, right_y = _dot(along_x, miss), _dot(along_y, miss)
        determinant = xx * yy - cross * cross
        safe = np.where(determinant > 1e-20, determinant, np.inf)
        step = np.column_stack([yy * right_x - cross * right_y, xx * right_y - cross * right_x])
        step /= safe[:, None]
        length = np.maximum(np.linalg.norm(step, axis=1, keepdims=True), 1e-12)
        xy = np.clip(xy + step * np.minimum(1.0, LARGEST_STEP * highest[0] / length), 0.0, highest)
    miss, _, _, direction, along = _residual(ray_map, points_mm, xy)
    lead = _bilinear(ray_map.lead_mm[..., None], xy)[0][:, 0]
    return Projected(
        xy=xy,
        miss_mm=np.linalg.norm(miss, axis=1),
        direction=direction,
        range_mm=lead + along,
    )


def _residual(
    ray_map: RayMap, points: np.ndarray, xy: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Perpendicular miss, how the ray moves per column and row there, direction, distance."""
    foot, foot_x, foot_y = _bilinear(ray_map.foot_mm, xy)
    way, way_x, way_y = _bilinear(ray_map.direction, xy)
    size = np.linalg.norm(way, axis=1, keepdims=True)
    way = way / size
    offset = points - foot
    along = _dot(offset, way)

    def perpendicular(vector: np.ndarray) -> np.ndarray:
        return vector - _dot(vector, way)[:, None] * way

    return (
        perpendicular(offset),
        perpendicular(foot_x + along[:, None] * way_x / size),
        perpendicular(foot_y + along[:, None] * way_y / size),
        way,
        along,
    )


def _bilinear(values: np.ndarray, xy: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Values (H, W, C) at map coordinates, and their slopes per column and row, each (N, C)."""
    column = np.clip(xy[:, 0].astype(np.int64), 0, values.shape[1] - 2)
    row = np.clip(xy[:, 1].astype(np.int64), 0, values.shape[0] - 2)
    right = (xy[:, 0] - column)[:, None]
    down = (xy[:, 1] - row)[:, None]
    a, b = values[row, column], values[row, column + 1]
    c, d = values[row + 1, column], values[row + 1, column + 1]
    top, bottom = a + right * (b - a), c + right * (d - c)
    slope_x = (1.0 - down) * (b - a) + down * (d - c)
    return top + down * (bottom - top), slope_x, bottom - top


def seeds(ray_map: RayMap, points_mm: np.ndarray) -> np.ndarray:
    """Map coordinates of the pixel that sees the skin nearest to each point, shape (N, 2)."""
    from scipy.spatial import KDTree

    stride = max(1, round(math.sqrt(ray_map.lead_mm.size / 60_000)))
    rows, columns = np.mgrid[
        : ray_map.lead_mm.shape[0] : stride, : ray_map.lead_mm.shape[1] : stride
    ]
    hit = ray_map.hit_mm[rows, columns]
    met = np.isfinite(hit[..., 0])
    places = np.column_stack([columns[met], rows[met]]).astype(np.float64)
    return places[KDTree(hit[met]).query(points_mm)[1]]


def _dot(left: np.ndarray, right: np.ndarray) -> np.ndarray:
    return np.einsum("ij,ij->i", left, right)
