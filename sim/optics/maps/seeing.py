"""What the camera sees of the skin, and how: millimetres per pixel and angle of incidence.

A triangle of area A [mm2] whose corners lie at pixel coordinates that span the area a [px2] has
sqrt(A / a) millimetres per pixel, foreshortening included; a vertex takes the mean of its
triangles' ratios weighted by A.
"""

from __future__ import annotations

import numpy as np

LEAST_AREA_PX2 = 1e-6
"""Triangles seen smaller than this are edge-on: their ratio says nothing."""


def mm_per_pixel(
    points_mm: np.ndarray, faces: np.ndarray, uv_px: np.ndarray, visible: np.ndarray
) -> np.ndarray:
    """Millimetres of skin per pixel at each vertex, shape (V,), float32; NaN where unseen.

    Args:
        points_mm: Vertices [mm], shape (V, 3).
        faces: Triangles, shape (F, 3).
        uv_px: Pixel coordinates of the vertices, shape (V, 2); NaN outside the view.
        visible: Vertices that the camera sees, shape (V,), bool.
    """
    whole = visible[faces].all(axis=1) & np.isfinite(uv_px[faces]).all(axis=(1, 2))
    corners, seen = points_mm[faces[whole]], uv_px[faces[whole]]
    area_mm2 = 0.5 * np.linalg.norm(
        np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1
    )
    one, two = seen[:, 1] - seen[:, 0], seen[:, 2] - seen[:, 0]
    area_px2 = 0.5 * np.abs(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])
    ratio = np.sqrt(area_mm2 / np.maximum(area_px2, LEAST_AREA_PX2))
    return _to_vertices(faces[whole], ratio, area_mm2, len(points_mm))


def _to_vertices(
    faces: np.ndarray, values: np.ndarray, weights: np.ndarray, count: int
) -> np.ndarray:
    """Weighted mean over each vertex's triangles, shape (count,), float32; NaN without any."""
    corners = faces.T.ravel()
    total = np.bincount(corners, np.tile(values * weights, 3), minlength=count)
    weight = np.bincount(corners, np.tile(weights, 3), minlength=count)
    return np.where(weight > 0.0, total / np.maximum(weight, 1e-300), np.nan).astype(np.float32)


def incidence_deg(inward: np.ndarray, to_camera: np.ndarray, visible: np.ndarray) -> np.ndarray:
    """Angle between the skin's normal and its line of sight [degree], shape (V,), float32.

    Args:
        inward: Unit normals into the sensor, shape (V, 3).
        to_camera: Unit vectors along the bent ray toward the camera, shape (V, 3).
        visible: Vertices that the camera sees, shape (V,), bool.
    """
    cosine = np.clip(np.einsum("ij,ij->i", inward, to_camera), 0.0, 1.0)
    return np.where(visible, np.degrees(np.arccos(cosine)), np.nan).astype(np.float32)
