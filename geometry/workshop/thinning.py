"""Triangles thinned out for STEP files, whose readers take a millisecond a facet.

Quadric decimation (Garland and Heckbert, Surface simplification using quadric error metrics, 1997)
as VTK does it, which halves again and again while the surface stays within a tolerance; where its
result is no closed body, manifold3d's collapses, which always are one. A volume alone does not tell
a block from one with two hundred pins, so the distance is measured, and bounded: where few facets
are too far off, more are written. STL and 3MF files hold all triangles.
"""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from geometry.body.csg_mesh import arrays, closed
from geometry.surface.isosurface import distance_mm
from workbench.core.base.errors import GeometryError

USUAL_FACETS = 2500
"""Facets of a part: 0.9 MB of STEP, and 2 s to read."""
MOST_FACETS = 20_000
"""Of a part that fewer would make another body: 8 MB, and 15 s to read."""
ENOUGH_FACETS = 600
"""A part with fewer is left as it is."""
WITHIN_MM = 0.1
"""Distance of thinned facets from the triangles beyond which nothing more is thinned out."""
FARTHEST_MM = 0.2
"""Largest distance of facets that are still the same body: what a printer's layers round off."""
SAME_VOLUME = 0.003
SLIVER_MM = 1e-5
"""A facet lower than this has no normal that a reader could trust."""
CLEAN_MM = 1e-4
"""Edges shorter than this are collapsed before facets are written."""
FIRST_MM = 0.005

Triangles = tuple[np.ndarray, np.ndarray]
"""Vertices (N, 3) [mm] and faces (M, 3)."""


def thinned(
    points_mm: np.ndarray, faces: np.ndarray, *, what: str
) -> tuple[np.ndarray, np.ndarray, float]:
    """Fewer facets of the same closed body, or more where fewer would be another one.

    Returns:
        Vertices (N, 3) [mm], triangles (M, 3), and their largest distance from the first ones,
        either way [mm], at most `FARTHEST_MM`.

    Raises:
        GeometryError: If no thinning leaves a sound body of few enough facets within that.
    """
    exact = points_mm, faces
    whole = closed(what, points_mm, faces).simplify(CLEAN_MM)
    volume_mm3 = float(whole.volume())
    if whole.num_tri() > USUAL_FACETS or not _writable(*arrays(whole), volume_mm3):
        # Collapses that hardly show, because the decimation takes its time by the triangle.
        whole = whole.simplify(FIRST_MM)
    count = USUAL_FACETS
    best = _fewer(whole, count, exact, volume_mm3)
    while best is None and 2 * count <= MOST_FACETS:
        count *= 2
        best = _fewer(whole, count, exact, volume_mm3)
    if best is None:
        raise GeometryError(
            f"{what} has {len(faces)} triangles, and no STEP file of at most {MOST_FACETS} flat "
            f"facets is within {FARTHEST_MM:g} mm of them",
            hint="use its STL or 3MF file",
            at="mould",
        )
    # More than usual were taken because fewer were tried in vain.
    fewer = best if count == USUAL_FACETS else None
    while fewer is not None and fewer.far_mm <= WITHIN_MM:
        best, count = fewer, fewer.solid.num_tri() // 2
        fewer = _fewer(best.solid, count, exact, volume_mm3) if count >= ENOUGH_FACETS else None
    return (*arrays(best.solid), best.far_mm)


class _Thin(NamedTuple):
    """A manifold and its distance from the triangles that were given."""

    solid: Any
    far_mm: float


def _fewer(whole: Any, count: int, exact: Triangles, volume_mm3: float) -> _Thin | None:
    """At most about so many facets of the same body, or None where there are none."""
    for solid in _candidates(whole, count):
        made = arrays(solid)
        if _writable(*made, volume_mm3):
            far_mm = _apart_mm(exact, made)
            if far_mm <= FARTHEST_MM:
                return _Thin(solid, far_mm)
    return None


def _candidates(whole: Any, count: int) -> Iterator[Any]:
    """Closed bodies of at most about so many facets, what is likely to be nearest first."""
    import pyvista

    if whole.num_tri() <= count:
        yield whole
    else:
        points, faces = arrays(whole)
        padded = np.column_stack([np.full(len(faces), 3), faces]).ravel()
        surface = pyvista.PolyData(points, padded).decimate(
            1.0 - count / len(faces), volume_preservation=True
        )
        with contextlib.suppress(GeometryError):
            places = np.asarray(surface.points, np.float64)
            solid = closed("part", places, surface.regular_faces).simplify(CLEAN_MM)
            if len(solid.decompose()) == 1:
                yield solid
    tolerance_mm = FARTHEST_MM / 8
    while tolerance_mm <= FARTHEST_MM:
        solid = whole.simplify(tolerance_mm)
        if solid.num_tri() <= count:
            yield solid
        tolerance_mm *= 2


def _writable(points: np.ndarray, faces: np.ndarray, volume_mm3: float) -> bool:
    """Whether the facets hold the volume and none of them is a sliver."""
    corners = points[faces]
    edges = np.roll(corners, -1, axis=1) - corners
    twice = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1)
    longest = np.linalg.norm(edges, axis=2).max(axis=1)
    held = np.einsum("ij,ij->i", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])).sum() / 6
    return bool(
        (twice > SLIVER_MM * longest).all()
        and abs(held - volume_mm3) <= SAME_VOLUME * abs(volume_mm3)
    )


def _apart_mm(exact: Triangles, made: Triangles) -> float:
    """Largest distance between two surfaces, from the vertices of either and the facets' middles.

    All vertices are asked: one pin among thousands of triangles is what thinning out may lose.
    """
    points, facets = made
    places = np.vstack([points, points[facets].mean(axis=1)])
    there_mm = float(distance_mm(points, facets, exact[0]).max())
    if there_mm > FARTHEST_MM:
        return there_mm
    return max(there_mm, float(distance_mm(*exact, places).max()))
