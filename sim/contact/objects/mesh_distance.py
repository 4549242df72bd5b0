"""Signed distance of a closed triangle mesh on a grid of samples.

Exact distance in a band around the surface; beyond it a lower bound from a Euclidean distance
transform, which is all that first touch needs.
The sign is a vote of three winding numbers, each counted along the columns of one axis, so that a
few missing or doubled faces do no harm. Sharp edges are rounded by about a sample, or by a stated
radius: {d <= -r} is the body shrunk by r, and its own distance less r the shrunk body grown again
(a morphological opening), which is the body with its convex edges rounded.
Left out: what is thinner than twice the radius vanishes.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.surface import closest_point, face_areas
from sim.contact.objects.redistance import Exact, redistanced
from sim.contact.objects.samples import SampleGrid, read_spline, spline
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import IndenterMesh

BAND_SAMPLES = 5.0
OUTER_SAMPLES = 2.5
"""Samples outside a rounded mesh up to which its distance is exact."""
SPLIT_SAMPLES = 6.0
"""Longest edge of the triangles that feet are sought on, in samples."""
MOST_SPLIT = 100_000
"""Squares of that edge that the surface may have; longer edges beyond."""
STAIRCASE = 3.0**0.5
"""Samples by which the band's rim on the lattice falls short of the true rim, at most."""
COLUMN_SHIFT = np.array([1.37e-4, 2.33e-4, 3.15e-4])
"""Shift of the columns [samples], so that none runs along an edge of a tidy mesh."""


def mesh_distance(
    mesh: IndenterMesh, grid: SampleGrid, *, band_samples: float = BAND_SAMPLES
) -> np.ndarray:
    """Signed distance of a closed mesh at all samples [mm], shape (A, B, C).

    Raises:
        DesignError: If the mesh encloses nothing: it is open or turned inside out.
    """
    shape = np.array(grid.shape)
    corners = np.asarray(mesh.points_mm, dtype=np.float64)[mesh.faces] - grid.origin_mm
    inside = _inside(corners, shape, grid.spacing_mm)
    if not inside.any() and not grid.partial:
        raise DesignError(
            f"the indenter mesh of {len(mesh.faces)} triangles encloses no volume",
            hint="repair it so that it is closed and its normals point outwards",
            at="indenter.mesh",
        )
    distance = _distance(corners, grid, band_samples)
    return np.where(inside, -distance, distance)


def rounded_mesh_distance(mesh: IndenterMesh, grid: SampleGrid, *, radius_mm: float) -> np.ndarray:
    """Signed distance of a mesh with its convex edges rounded [mm], shape (A, B, C).

    Raises:
        DesignError: If the mesh is nowhere thicker than twice the radius.
    """
    band_samples = radius_mm / grid.spacing_mm + BAND_SAMPLES
    shrunk = mesh_distance(mesh, grid, band_samples=band_samples) + radius_mm
    if not (shrunk < 0.0).any() and not grid.partial:
        raise DesignError(
            f"a rounding of {radius_mm:g} mm leaves nothing of the indenter mesh: it is nowhere "
            f"thicker than {2.0 * radius_mm:g} mm",
            hint="lower indenter.mesh_rounding_mm",
            at="indenter.mesh_rounding_mm",
        )
    # Beyond, the distance of the sharp mesh is the lower bound that first touch needs.
    band_mm = radius_mm + OUTER_SAMPLES * grid.spacing_mm
    exact = _shrunk_function(mesh, grid, shrunk - radius_mm, radius_mm)
    return redistanced(shrunk, grid.spacing_mm, band_mm=band_mm, exact=exact) - radius_mm


def _shrunk_function(
    mesh: IndenterMesh, grid: SampleGrid, sampled: np.ndarray, radius_mm: float
) -> Exact:
    """The signed distance to the mesh plus the radius, in samples; its sign from the samples."""
    coefficients = spline(sampled)
    points, faces = _small_triangles(mesh, grid, radius_mm)

    def exact(steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        side = np.where(read_spline(coefficients, steps) < 0.0, -1.0, 1.0)
        places = grid.origin_mm + grid.spacing_mm * steps
        feet, away, _ = closest_point(points, faces, places)
        slopes = (side / np.maximum(away, 1e-9))[:, None] * (places - feet)
        return (side * away + radius_mm) / grid.spacing_mm, slopes

    return exact


def _small_triangles(
    mesh: IndenterMesh, grid: SampleGrid, radius_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """The surface about the grid, its triangles split: a search by balls is slow with long ones."""
    import trimesh

    margin_mm = radius_mm + BAND_SAMPLES * grid.spacing_mm
    low = grid.origin_mm - margin_mm
    high = grid.origin_mm + grid.spacing_mm * (np.array(grid.shape) - 1.0) + margin_mm

    def about(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
        corners = points[faces]
        apart = (corners.max(axis=1) < low) | (corners.min(axis=1) > high)
        return faces[~apart.any(axis=1)]

    faces = about(mesh.points_mm, mesh.faces)
    edge_mm = SPLIT_SAMPLES * grid.spacing_mm
    area_mm2 = float(face_areas(mesh.points_mm, faces).sum())
    edge_mm = max(edge_mm, (area_mm2 / MOST_SPLIT) ** 0.5)
    points, faces, *_ = trimesh.remesh.subdivide_to_size(
        mesh.points_mm, faces, max_edge=edge_mm, max_iter=20
    )
    return points, about(points, faces)


def _distance(corners: np.ndarray, grid: SampleGrid, band_samples: float) -> np.ndarray:
    """Unsigned distance of all samples [mm]: exact within the band, a lower bound beyond.

    The straight line to the surface meets a band sample no more than half a cell diagonal aside
    and half a diagonal inside the rim, so the distance is at least that to the nearest band
    sample plus the band less a diagonal. Where a window cuts the body, what lies beyond is no
    nearer than the window's side.
    """
    from scipy.ndimage import distance_transform_edt

    from sim.contact.objects.mesh_distance_kernels import band_distance

    spacing_mm = grid.spacing_mm
    band_mm = band_samples * spacing_mm
    squared = np.full(grid.shape, 4.0 * band_mm**2, np.float32)
    triangles = np.ascontiguousarray(corners, dtype=np.float32)
    band_distance(triangles, squared, float(spacing_mm), float(band_mm))
    distance = np.sqrt(squared.astype(np.float64))
    far = squared >= band_mm**2
    if far.all():
        # scipy's transform has no meaning without a sample to measure to.
        diagonal_mm = spacing_mm * float(np.linalg.norm(grid.shape))
        return np.clip(grid.to_cut_mm(), band_mm, max(band_mm, diagonal_mm))
    beyond = spacing_mm * (np.asarray(distance_transform_edt(far)) + band_samples - STAIRCASE)
    if grid.partial:
        beyond = np.maximum(np.minimum(beyond, grid.to_cut_mm()), band_mm)
    return np.where(far, beyond, distance)


def _inside(corners: np.ndarray, shape: np.ndarray, spacing_mm: float) -> np.ndarray:
    """Whether two of three winding numbers put a sample inside."""
    from sim.contact.objects.mesh_distance_kernels import ray_crossings

    votes = np.zeros(tuple(shape), np.int8)
    shifted = corners - COLUMN_SHIFT * spacing_mm
    for axis in range(3):
        order = [(axis + 1) % 3, (axis + 2) % 3, axis]
        crossings = np.zeros(tuple(shape[order]), np.int32)
        along = np.ascontiguousarray(shifted[:, :, order])
        ray_crossings(along, crossings, float(spacing_mm))
        winding = np.cumsum(crossings, axis=2) > 0
        votes += winding.transpose(np.argsort(order)).astype(np.int8)
    return votes >= 2
