"""A function with the right zero set made a signed distance again, on its own samples.

The zero set is a cloud of points: where it crosses the grid's edges, moved onto the spline's zero.
A sample's foot starts at the nearest point of the cloud and is moved in turn along the tangent
plane to the foot of the perpendicular and back onto the surface, which at a sharp edge are
alternating projections onto its two sides. Source of the step: Chopp, Some improvements of the
fast marching method, SIAM J. Sci. Comput. 23 (2001), 230-244.
Beyond the band values are scaled down to a lower bound.
The spline cuts a crease of the function short by up to a sample; feet there are found with the
exact function where the caller has one.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim.contact.objects.samples import read_slopes, read_spline, spline

Exact = Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]]
"""The function and its unit slopes, (N,) and (N, 3), at places (N, 3), all in samples."""

STEPS = 4
CREASE_STEPS = 3
CREASED = 0.03
"""Samples by which a place must be farther away than the given distance says."""
ON_SURFACE = 0.02
"""A foot is taken if the function there is below this, in samples."""
LEAST_SLOPE = 0.1
"""Flatter places of the function are left where they are."""
MOST_MOVE = 1.0
"""Samples by which a point of the cloud may be moved onto the surface."""


def redistanced(
    values: np.ndarray, spacing_mm: float, *, band_mm: float, exact: Exact | None = None
) -> np.ndarray:
    """Signed distance [mm] to the zero set of sampled values, shape (A, B, C).

    Args:
        values: Samples of a function that is negative inside [mm]; near its zero set its slope is
            near 1, and nowhere much larger.
        spacing_mm: Distance of samples.
        band_mm: How far from the surface the distance is exact; a lower bound beyond.
        exact: The function itself where it is a distance, but to something that reaches farther
            than its own zero set; slow, so used at creases only.
    """
    from scipy.spatial import KDTree

    scaled = values / spacing_mm
    coefficients = spline(scaled)
    cloud = _cloud(scaled, coefficients)
    if not len(cloud):
        return values
    band = band_mm / spacing_mm
    steps = np.stack(np.unravel_index(np.arange(values.size), values.shape), axis=1).astype(float)
    # The function over its steepest slope is a lower bound, so no sample of the band is left out.
    slopes = np.stack(list(np.gradient(scaled))).reshape(3, -1)
    steepest = max(1.0, float(np.linalg.norm(slopes, axis=0).max()))
    bound = np.abs(scaled.ravel()) / steepest
    near = np.flatnonzero(bound < band)
    found, owner = KDTree(cloud).query(steps[near])
    foot, distance = cloud[owner], np.asarray(found, dtype=np.float64)
    for _ in range(STEPS):
        foot, distance = _nearer(steps[near], foot, distance, coefficients)
    if exact is not None:
        # A distance with creases is too small only where a crease is nearest.
        given = scaled.ravel()[near]
        creased = np.flatnonzero((given > 0.0) & (distance - given > CREASED))
        distance[creased] = _at_creases(steps[near[creased]], foot[creased], exact)
        # Inside, and outside away from creases, what was given is the distance already.
        farther = (given > 0.0) & (distance - given > CREASED)
        distance = np.where(farther, distance, np.abs(given))
    bound[near] = np.minimum(distance, np.maximum(band, bound[near]))
    return np.copysign(bound, scaled.ravel()).reshape(values.shape) * spacing_mm


def _cloud(scaled: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Points on the zero set, counted in samples, shape (P, 3)."""
    points = []
    for axis in range(3):
        first = np.moveaxis(scaled, axis, 0)[:-1]
        second = np.moveaxis(scaled, axis, 0)[1:]
        crossed = np.nonzero((first < 0.0) != (second < 0.0))
        place = np.stack(crossed, axis=1).astype(np.float64)
        place[:, 0] += first[crossed] / (first[crossed] - second[crossed])
        points.append(np.insert(place[:, 1:], axis, place[:, 0], axis=1))
    cloud = np.concatenate(points)
    return _onto(cloud, coefficients) if len(cloud) else cloud


def _onto(places: np.ndarray, coefficients: np.ndarray) -> np.ndarray:
    """Places after a Newton step along the slope."""
    slopes = read_slopes(coefficients, places)
    steep_2 = np.maximum(np.einsum("ij,ij->i", slopes, slopes), LEAST_SLOPE**2)
    move = -(read_spline(coefficients, places) / steep_2)[:, None] * slopes
    length = np.linalg.norm(move, axis=1, keepdims=True)
    return places + move * np.minimum(1.0, MOST_MOVE / np.maximum(length, 1e-12))


def _nearer(
    places: np.ndarray, foot: np.ndarray, distance: np.ndarray, coefficients: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Feet moved along the tangent plane and back, where that brings them nearer."""
    normal = read_slopes(coefficients, foot)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), LEAST_SLOPE)
    offset = places - foot
    tangent = offset - np.einsum("ij,ij->i", offset, normal)[:, None] * normal
    moved = _onto(_onto(foot + tangent, coefficients), coefficients)
    new = np.linalg.norm(places - moved, axis=1)
    better = (new < distance) & (np.abs(read_spline(coefficients, moved)) < ON_SURFACE)
    return np.where(better[:, None], moved, foot), np.where(better, new, distance)


def _at_creases(places: np.ndarray, foot: np.ndarray, exact: Exact) -> np.ndarray:
    """Distances, (N,), of places (N, 3) to the zero set of a function with creases near `foot`."""

    def landed(start: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        for _ in range(2):
            value, slope = exact(start)
            start = start - value[:, None] * slope
        value, slope = exact(start)
        return (
            start,
            slope,
            np.where(value < ON_SURFACE, np.linalg.norm(places - start, axis=1), np.inf),
        )

    foot, normal, distance = landed(foot)
    for _ in range(CREASE_STEPS):
        offset = places - foot
        tangent = offset - np.einsum("ij,ij->i", offset, normal)[:, None] * normal
        moved, turned, new = landed(foot + tangent)
        better = new < distance
        foot, normal = (
            np.where(better[:, None], moved, foot),
            np.where(better[:, None], turned, normal),
        )
        distance = np.where(better, new, distance)
    return np.where(np.isfinite(distance), distance, np.linalg.norm(places - foot, axis=1))
