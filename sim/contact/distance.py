"""Signed distance of a closed triangle mesh, sampled on a grid for quadratic B-splines.

Exact distance in a band around the surface; beyond it a lower bound from a Euclidean distance
transform, which is all that first touch needs.
The sign is a vote of three winding numbers, each counted along the columns of one axis, so that a
few missing or doubled faces do no harm. Sharp edges are rounded by about a sample.
Left out: bodies with more than `MOST_SAMPLES` samples are sampled more coarsely than asked.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core.errors import DesignError
from workbench.core.indenter import IndenterMesh

MOST_SAMPLES = 3_000_000
"""12 MB in single precision; the spacing grows with the cube root of the excess."""
BAND_SAMPLES = 5.0
PADDING_SAMPLES = 6
STAIRCASE = 3.0**0.5
"""Samples by which the band's rim on the lattice falls short of the true rim, at most."""
COLUMN_SHIFT = np.array([1.37e-4, 2.33e-4, 3.15e-4])
"""Shift of the columns [samples], so that none runs along an edge of a tidy mesh."""


@dataclass(frozen=True, kw_only=True, slots=True)
class SampledDistance:
    """A distance field on a grid."""

    coefficients: np.ndarray
    """Quadratic B-spline coefficients [mm], shape (A, B, C), float64."""
    origin_mm: np.ndarray
    """Position of sample (0, 0, 0) [mm], shape (3,)."""
    spacing_mm: float
    """Distance of samples; larger than asked where memory bounds it."""


def sample_mesh(mesh: IndenterMesh, *, spacing_mm: float) -> SampledDistance:
    """Sample the signed distance of a closed mesh.

    Raises:
        DesignError: If the mesh encloses nothing: it is open or turned inside out.
    """
    from scipy.ndimage import spline_filter

    points = np.asarray(mesh.points_mm, dtype=np.float64)
    extent = np.ptp(points, axis=0)
    count = np.prod(extent / spacing_mm + 2 * PADDING_SAMPLES + 1)
    spacing_mm *= max(1.0, float(count / MOST_SAMPLES) ** (1.0 / 3.0))
    origin_mm = points.min(axis=0) - PADDING_SAMPLES * spacing_mm
    shape = np.ceil(extent / spacing_mm).astype(int) + 2 * PADDING_SAMPLES + 1
    corners = points[mesh.faces] - origin_mm
    inside = _inside(corners, shape, spacing_mm)
    if not inside.any():
        raise DesignError(
            f"the indenter mesh of {len(mesh.faces)} triangles encloses no volume",
            hint="repair it so that it is closed and its normals point outwards",
            at="indenter.mesh",
        )
    distance = _distance(corners, shape, spacing_mm)
    signed = np.where(inside, -distance, distance)
    coefficients = spline_filter(signed, order=2, mode="mirror", output=np.float64)
    return SampledDistance(
        coefficients=coefficients, origin_mm=origin_mm, spacing_mm=float(spacing_mm)
    )


def _distance(corners: np.ndarray, shape: np.ndarray, spacing_mm: float) -> np.ndarray:
    """Unsigned distance of all samples [mm]: exact within the band, a lower bound beyond.

    The straight line to the surface meets a band sample no more than half a cell diagonal aside
    and half a diagonal inside the rim, so the distance is at least that to the nearest band
    sample plus the band less a diagonal.
    """
    from scipy.ndimage import distance_transform_edt

    from sim.contact.distance_kernels import band_distance

    band_mm = BAND_SAMPLES * spacing_mm
    squared = np.full(tuple(shape), 4.0 * band_mm**2, np.float32)
    triangles = np.ascontiguousarray(corners, dtype=np.float32)
    band_distance(triangles, squared, float(spacing_mm), float(band_mm))
    distance = np.sqrt(squared.astype(np.float64))
    far = squared >= band_mm**2
    beyond = np.asarray(distance_transform_edt(far)) + BAND_SAMPLES - STAIRCASE
    return np.where(far, spacing_mm * beyond, distance)


def _inside(corners: np.ndarray, shape: np.ndarray, spacing_mm: float) -> np.ndarray:
    """Whether two of three winding numbers put a sample inside."""
    from sim.contact.distance_kernels import ray_crossings

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
