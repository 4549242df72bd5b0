"""The object's surface near the skin as even triangles, for decks of other programs.

Contoured from the very distance that our solver uses (flying edges); vertices nearer to each other
than a share of the step are merged, because slivers spoil other programs' search for contact.
"""

from __future__ import annotations

import numpy as np

from sim.contact.objects.collider import Collider

STEP_MM = 0.12
"""Edge of a triangle [mm]: its chord leaves a ball of radius 3 mm by 0.6 um."""
STEPS_PER_RADIUS = 3.0
FINEST_MM = 0.05
MERGED_SHARE = 0.4
"""Vertices nearer than this share of a step become one."""


def near_surface(
    collider: Collider, low_mm: np.ndarray, high_mm: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Triangles of the object's surface within a box of its own frame.

    Args:
        collider: The object.
        low_mm: Lower corner of the box, shape (3,).
        high_mm: Upper corner, shape (3,).

    Returns:
        Vertices [mm], shape (N, 3), and triangles, shape (M, 3), none if the surface is elsewhere.
    """
    import pyvista

    from geometry.surface.isosurface import isosurface

    step_mm = min(STEP_MM, max(collider.least_radius_mm / STEPS_PER_RADIUS, FINEST_MM))
    axes = [
        np.arange(low, high + step_mm, step_mm) for low, high in zip(low_mm, high_mm, strict=True)
    ]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    values = collider.distance(grid.reshape(-1, 3))[0].reshape(grid.shape[:3])
    found = isosurface(values, low_mm, step_mm) if values.max() > 0.0 else None
    if found is None:
        return np.zeros((0, 3)), np.zeros((0, 3), dtype=np.int64)
    points, faces = found
    padded = np.column_stack([np.full(len(faces), 3), faces]).ravel()
    merged = pyvista.PolyData(points, padded).clean(
        tolerance=MERGED_SHARE * step_mm, absolute=True, lines_to_points=False, polys_to_lines=True
    )
    return np.asarray(merged.points, dtype=np.float64), merged.regular_faces.astype(np.int64)
