"""The rigid object in a deck: a thin shell of wedges along the part of its surface that may touch.

CalculiX has no rigid triangles, so each triangle becomes a wedge C3D6 whose first face lies on the
surface and whose nodes are all moved by prescription: nothing of it deforms, and turns are exact at
the end of every step. Left out: what lies farther from the skin than `NEAR_MM` on the whole path.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.surface import face_areas, vertex_normals
from sim.contact.motion.approach import Approach
from sim.contact.objects.collider import Collider
from sim.contact.region.refinement import path_samples
from workbench.core.base.errors import SolveError

NEAR_MM = 1.5
"""Gap to the undeformed skin up to which a part of the object may be met [mm]: skin bulges."""
SHELL_SHARE = 0.25
"""Thickness of the shell over the edge of a triangle; thin, so that no wedge turns inside out."""
PROJECTIONS = 4
"""Newton steps that bring a vertex onto the surface; contoured vertices start within microns."""
LEAST_AREA_SHARE = 1e-4
"""Triangles smaller than this share of the mean are left out: programs divide by their area."""
STEP_MM = 0.12
"""Edge of a triangle [mm]: its chord leaves a ball of radius 3 mm by 0.6 um."""
STEPS_PER_RADIUS = 3.0
FINEST_MM = 0.05
MERGED_SHARE = 0.4
"""Vertices nearer than this share of a step become one."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Shell:
    """Wedges in the object's own frame; their first three nodes are on the surface."""

    points_mm: np.ndarray
    """Nodes, shape (P, 3)."""
    wedges: np.ndarray
    """Node numbers, shape (T, 6): the outer triangle, clockwise from outside, then the inner."""


def near_box_mm(points_mm: np.ndarray, approach: Approach) -> tuple[np.ndarray, np.ndarray]:
    """Lower and upper corner [mm], object's frame, of the skin that comes near it on the path.

    Where regions are driven the skin may come from as far as it is driven.

    Args:
        points_mm: Skin of the part that takes part, shape (N, 3).
        approach: The object and its path.

    Raises:
        SolveError: If the object stays clear of the skin.
    """
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    near_mm = NEAR_MM + _driven_mm(points_mm, approach)
    for progress in path_samples(approach):
        origin_mm, rotation = approach.pose(float(progress))
        places = (points_mm - origin_mm) @ rotation
        places = places[approach.collider.distance(places)[0] < near_mm]
        if len(places):
            low, high = np.minimum(low, places.min(axis=0)), np.maximum(high, places.max(axis=0))
    if not np.isfinite(low).all():
        raise SolveError(
            f"the object stays more than {near_mm:g} mm from the skin on the whole path",
            hint="there is nothing to compare: press it in",
        )
    whole_mm = approach.collider.reach_mm + NEAR_MM
    return np.maximum(low - near_mm, -whole_mm), np.minimum(high + near_mm, whole_mm)


def _driven_mm(points_mm: np.ndarray, approach: Approach) -> float:
    """Farthest way that the drives could take any of the points (N, 3) [mm]."""
    ways_mm = [
        float(np.linalg.norm(drive.displacement_mm(points_mm, frame + 1.0), axis=1).max())
        for drive in approach.press.actuations
        for frame in range(approach.frame_count)
    ]
    return max(ways_mm, default=0.0)


def near_surface(
    collider: Collider, low_mm: np.ndarray, high_mm: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Even triangles of the object's surface within a box of its own frame.

    Contoured (flying edges) from the very distance that our solver uses; vertices nearer to each
    other than a share of the step are merged, because slivers spoil other programs' search for
    contact.

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


def make_shell(points_mm: np.ndarray, faces: np.ndarray, collider: Collider) -> Shell:
    """Wedges along triangles of the object's surface.

    Args:
        points_mm: Vertices, object's frame, shape (N, 3), near the surface.
        faces: Triangles, shape (M, 3).
        collider: The object, whose surface is met exactly.

    Raises:
        SolveError: If no triangle is left.
    """
    placed = np.array(points_mm, dtype=np.float64)
    for _ in range(PROJECTIONS):
        away_mm, slope = collider.distance(placed)
        placed -= away_mm[:, None] * slope / np.maximum((slope**2).sum(axis=1), 0.25)[:, None]
    areas_mm2 = face_areas(placed, faces)
    faces = faces[areas_mm2 > LEAST_AREA_SHARE * areas_mm2.mean()] if len(faces) else faces
    if not len(faces):
        raise SolveError(
            "the object has no surface near the skin",
            hint="press deeper, or report it with the design",
        )
    used, faces = np.unique(faces, return_inverse=True)
    placed, faces = placed[used], _outward(placed[used], faces.reshape(-1, 3), collider)
    edge_mm = float(np.sqrt(2.0 * face_areas(placed, faces).mean()))
    inner = placed - SHELL_SHARE * edge_mm * vertex_normals(placed, faces)
    # The nodes 1-2-3 of a wedge are counter-clockwise as seen from its nodes 4-5-6, the inner ones.
    first = faces[:, ::-1]
    return Shell(
        points_mm=np.vstack([placed, inner]), wedges=np.hstack([first, first + len(placed)])
    )


def _outward(points_mm: np.ndarray, faces: np.ndarray, collider: Collider) -> np.ndarray:
    """The triangles, counter-clockwise from outside."""
    corners = points_mm[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    _, slope = collider.distance(corners.mean(axis=1))
    inward = np.einsum("mi,mi->m", normal, slope) < 0.0
    return np.where(inward[:, None], faces[:, ::-1], faces)
