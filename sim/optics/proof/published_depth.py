"""The paper's own depth map, for comparison: project particles, drop hidden ones, interpolate.

Each particle of the deformed skin is projected without refraction (Eq. 1, with `depth_z` rather
than the range that its text stores), dropped if the straight line to the camera meets the skin
before it, and the scattered depths are interpolated over the pixels by SciPy's cubic `griddata`,
as the released code does. It knows no refraction, loses the parts of the image that lie outside
the convex hull of the particles, and blurs every edge of an occlusion. The workbench rasterises
the skin instead; `validate optics` prints the difference.
Source: SimTac, "Online image rendering", Eq. 1-3.
"""

from __future__ import annotations

import numpy as np

from sim.optics.camera.camera import depth_z, pixel_centres, project
from workbench.core.base.check import expect
from workbench.core.design.camera import Camera
from workbench.core.result.results import Skin

SELF_MM = 1e-3
"""A particle's own triangles lie this near the end of its line of sight [mm]."""


def published_depth_z(skin: Skin, camera: Camera, displacement_mm: np.ndarray) -> np.ndarray:
    """Depth along the optical axis [mm], shape (H, W), float64; NaN outside the particles.

    Args:
        skin: The undeformed skin; its vertices are the particles.
        camera: Any lens.
        displacement_mm: Of the vertices [mm], shape (V, 3).
    """
    from scipy.interpolate import griddata

    expect(displacement_mm, f"{len(skin.points_mm)} 3", name="displacement")
    points = skin.points_mm + displacement_mm
    uv = project(camera, points)
    known = np.flatnonzero(_in_sight(points, skin.faces, camera) & np.isfinite(uv).all(axis=1))
    values = depth_z(camera, points[known])
    centres = pixel_centres(camera)
    filled = griddata(uv[known], values, centres, method="cubic")
    return filled.reshape(camera.height_px, camera.width_px)


def _in_sight(points_mm: np.ndarray, faces: np.ndarray, camera: Camera) -> np.ndarray:
    """Particles that no triangle hides from the camera, shape (V,), bool."""
    from geometry.surface.rays import RayCaster

    eye = np.asarray(camera.position_mm, dtype=np.float64)
    line = points_mm - eye
    distance = np.linalg.norm(line, axis=1)
    start = np.broadcast_to(eye, line.shape)
    toward = line / np.maximum(distance, 1e-12)[:, None]
    hidden = RayCaster(points_mm, faces).occluded(start, toward, distance - SELF_MM)
    return ~hidden
