"""The camera: pixels to rays and back, and the rays bent by the rigid transparent support.

Pixel (column, row) has its centre at (column + 0.5, row + 0.5); the optical axis meets the image
centre (W/2, H/2). Pixels are square and `fov_x_deg` is the only field of view, so one focal length
in pixels serves both axes; `lens` has the curve of each lens model, its distortion and its inverse.

The paper's Eq. 2 has a second focal length from the height with the same angle, which would make
pixels oblong, and its Eq. 1 stores the range where Eq. 3 reads z. Here `depth_z` is the coordinate
along the optical axis and `range` the length of the line of sight; neither stands for the other.
Blur, vignetting and noise come later, see `image_sensor`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim.optics.camera.lens import lens_of
from sim.optics.camera.refraction import refract
from workbench.core.base.check import expect
from workbench.core.design.camera import Camera
from workbench.core.result.results import Skin


@dataclass(frozen=True, kw_only=True, slots=True)
class Rays:
    """One ray per pixel, row by row, inside the clear body; constant for a design."""

    origin_mm: np.ndarray
    """Where each ray starts [mm]: on the cavity wall, or at the camera, shape (N, 3), float32."""
    direction: np.ndarray
    """Unit directions away from the camera, shape (N, 3), float32."""
    transmittance: np.ndarray
    """Share of light that passes the cavity wall, shape (N,), float32."""
    width_px: int
    height_px: int


def focal_px(camera: Camera) -> float:
    """Focal length [px] of the lens model, from the width and the horizontal field of view.

    Raises:
        DesignError: If the distortion is not one to one over the image.
    """
    return lens_of(camera).focal_px


def rotation_camera_to_sensor(camera: Camera) -> np.ndarray:
    """Rotation matrix, shape (3, 3): its columns are the camera's +X, +Y (down), +Z (forward)."""
    w, x, y, z = np.asarray(camera.wxyz, dtype=np.float64) / np.linalg.norm(camera.wxyz)
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def depth_z(camera: Camera, points_mm: np.ndarray) -> np.ndarray:
    """Depth along the optical axis [mm] of points in the sensor frame, shape (..., 3) to (...)."""
    return (points_mm - np.asarray(camera.position_mm)) @ rotation_camera_to_sensor(camera)[:, 2]


def project(camera: Camera, points_mm: np.ndarray) -> np.ndarray:
    """Pixel coordinates [px], shape (N, 2), of points in the sensor frame, without refraction.

    NaN where no pixel exists: behind a lens that is not a fisheye, or at the optical centre.

    Raises:
        DesignError: If the distortion is not one to one over the image.
    """
    expect(points_mm, "N 3", name="points")
    lens = lens_of(camera)
    seen = (points_mm - np.asarray(camera.position_mm)) @ rotation_camera_to_sensor(camera)
    sideways = np.hypot(seen[:, 0], seen[:, 1])
    theta = np.arctan2(sideways, seen[:, 2])
    if lens.angular:
        visible = np.linalg.norm(seen, axis=1) > 0.0
        t = theta
    else:
        visible = seen[:, 2] > 0.0
        t = np.tan(np.where(visible, theta, 0.0))
    scale = np.divide(t, sideways, out=np.zeros_like(t), where=sideways > 0.0)
    offset = lens.focal_px * lens.bend(seen[:, :2] * scale[:, None])
    centre = np.array([camera.width_px / 2.0, camera.height_px / 2.0])
    return np.where(visible[:, None], centre + offset, np.nan)


def pixel_directions(camera: Camera, uv_px: np.ndarray) -> np.ndarray:
    """Unit directions in the sensor frame, shape (N, 3), through pixel coordinates (N, 2).

    Coordinates outside the image have directions too, see `lens`.

    Raises:
        DesignError: If the distortion is not one to one over the image.
    """
    expect(uv_px, "N 2", name="pixel coordinates")
    lens = lens_of(camera)
    offset = uv_px - np.array([camera.width_px / 2.0, camera.height_px / 2.0])
    ideal = lens.straighten(offset / lens.focal_px)
    t = np.hypot(ideal[:, 0], ideal[:, 1])
    # Beyond 180 degrees a fisheye's image circle has ended; such pixels look straight back.
    theta = np.minimum(t, math.pi) if lens.angular else np.arctan(t)
    around = np.divide(ideal, t[:, None], out=np.zeros_like(ideal), where=t[:, None] > 0)
    seen = np.column_stack([around * np.sin(theta)[:, None], np.cos(theta)])
    return seen @ rotation_camera_to_sensor(camera).T


def axis_cosines(camera: Camera) -> np.ndarray:
    """Cosine of the angle between each pixel's line of sight and the optical axis, (H * W,)."""
    ahead = rotation_camera_to_sensor(camera)[:, 2]
    return pixel_directions(camera, pixel_centres(camera)) @ ahead


def unproject(camera: Camera, uv_px: np.ndarray, *, range_mm: np.ndarray) -> np.ndarray:
    """Points in the sensor frame [mm], shape (N, 3), at a range [mm] (not a depth_z) per pixel."""
    along = np.asarray(range_mm)[:, None]
    return np.asarray(camera.position_mm) + along * pixel_directions(camera, uv_px)


def pixel_centres(camera: Camera) -> np.ndarray:
    """Pixel coordinates of all pixel centres [px], row by row, shape (H * W, 2)."""
    columns, rows = np.meshgrid(
        np.arange(camera.width_px) + 0.5, np.arange(camera.height_px) + 0.5, indexing="xy"
    )
    return np.column_stack([columns.ravel(), rows.ravel()])


def refracted_rays(camera: Camera, cavity: Skin, refractive_index: float) -> Rays:
    """One ray per pixel, bent where it enters the rigid support through the cavity wall.

    The support does not move, so the rays are computed once per design. Smooth normals are
    interpolated on the wall: flat ones leave facets of 0.9 px in the image. A ray that misses
    the wall (toward the base), and every ray at index 1, goes straight on from the camera.

    Args:
        camera: Camera inside the cavity.
        cavity: Inner face of the support, normals out of the sensor.
        refractive_index: Index of support and elastomer [1]; the cavity holds air.
    """
    from geometry.surface.rays import RayCaster

    direction = pixel_directions(camera, pixel_centres(camera))
    origin = np.broadcast_to(np.asarray(camera.position_mm, dtype=np.float64), direction.shape)
    transmittance = np.ones(len(direction))
    if refractive_index != 1.0:
        distance, face, weights = RayCaster(cavity.points_mm, cavity.faces).hits(origin, direction)
        met = np.flatnonzero(face >= 0)
        origin, direction = origin.copy(), direction.copy()
        origin[met] += distance[met, None] * direction[met]
        corners = cavity.normals[cavity.faces[face[met]]]
        normal = np.einsum("nk,nkd->nd", weights[met], corners)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        direction[met], transmittance[met] = refract(
            direction[met], normal, index_from=1.0, index_to=refractive_index
        )
    return Rays(
        origin_mm=np.ascontiguousarray(origin, dtype=np.float32),
        direction=np.ascontiguousarray(direction, dtype=np.float32),
        transmittance=transmittance.astype(np.float32),
        width_px=camera.width_px,
        height_px=camera.height_px,
    )
