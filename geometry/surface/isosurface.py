"""Distance to triangles, and the surface where a function sampled on a grid is zero, by VTK.

Source: Schroeder and others, Flying edges, IEEE LDAV 2015. Linear along each grid edge, so a true
distance is met to the square of the step over the radius of curvature.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geometry.surface.surface import mesh_volume

ZERO_SHARE = 1e-6
"""Samples nearer to zero than this share of a step are moved off it: a vertex on a grid node
would be met by several cells, and the surface would not be closed."""


def distance_mm(points_mm: np.ndarray, faces: np.ndarray, places_mm: np.ndarray) -> np.ndarray:
    """Exact distance of many places (N, 3) to a triangle mesh [mm], shape (N,), not signed.

    VTK's cell locator: 100,000 places inside a finger in about a second, where the search by
    balls of `surface.closest_point` suits places near the surface only.
    """
    import pyvista

    padded = np.column_stack([np.full(len(faces), 3), faces]).ravel()
    found = pyvista.PolyData(places_mm).compute_implicit_distance(
        pyvista.PolyData(points_mm, padded)
    )
    return np.abs(np.asarray(found["implicit_distance"], dtype=np.float64))


def isosurface(
    values: np.ndarray, low_mm: Sequence[float] | np.ndarray, step_mm: float
) -> tuple[np.ndarray, np.ndarray] | None:
    """Closed triangles around the samples that are negative.

    Args:
        values: Samples [mm], shape (X, Y, Z), positive on the border of the grid.
        low_mm: Place of the first sample.
        step_mm: Distance of neighbouring samples.

    Returns:
        Vertices [mm] (N, 3) and outward triangles (M, 3), or None if no sample is negative.
    """
    import pyvista

    if not (values < 0.0).any():
        return None
    least = ZERO_SHARE * step_mm
    shifted = np.where(np.abs(values) < least, np.copysign(least, values), values)
    grid = pyvista.ImageData(dimensions=values.shape, spacing=(1.0, 1.0, 1.0))
    grid.point_data["value"] = shifted.ravel(order="F")
    found = grid.contour([0.0], scalars="value", method="flying_edges", compute_normals=False)
    points = np.asarray(low_mm) + step_mm * np.asarray(found.points, dtype=np.float64)
    faces = found.regular_faces.astype(np.int32)
    # Towards larger values is outward; which way VTK turns its triangles is not documented.
    if mesh_volume(points, faces) < 0.0:
        faces = faces[:, ::-1].copy()
    return points, faces
