"""Triangles thinned out for STEP files, whose readers take a millisecond a facet.

Quadric decimation (Garland and Heckbert, Surface simplification using quadric error metrics, 1997)
as VTK does it, which halves again and again while the surface stays within a tolerance; where its
result is no closed body, manifold3d's collapses, which always are one. STL and 3MF files hold all
triangles.
"""

from __future__ import annotations

import contextlib
from typing import Any

import numpy as np

from geometry.csg_mesh import arrays, closed
from geometry.isosurface import distance_mm
from workbench.core.errors import GeometryError

MOST_FACETS = 2500
"""Facets of a part: 0.9 MB of STEP, and 2 s to read."""
ENOUGH_FACETS = 600
"""A part with fewer is left as it is."""
WITHIN_MM = 0.1
"""Largest distance of thinned facets from the triangles, where `MOST_FACETS` allow it."""
SAME_VOLUME = 0.003
SLIVER_MM = 1e-5
"""A facet lower than this has no normal that a reader could trust."""
CLEAN_MM = 1e-4
"""Edges shorter than this are collapsed before facets are written."""
FIRST_MM = 0.005
PLACES = 20_000
"""Places at which the distance is measured, at most."""


def thinned(
    points_mm: np.ndarray, faces: np.ndarray, *, what: str
) -> tuple[np.ndarray, np.ndarray, float]:
    """Fewer facets of the same closed body.

    Returns:
        Vertices (N, 3) [mm], triangles (M, 3), and their largest distance from the first ones,
        either way [mm].

    Raises:
        GeometryError: If no thinning leaves a sound body of few enough facets.
    """
    exact = points_mm, faces
    whole = closed(what, points_mm, faces).simplify(CLEAN_MM)
    volume_mm3, best = float(whole.volume()), (*arrays(whole), 0.0)
    if _many(best) or not _writable(*best[:2], volume_mm3):
        # Collapses that hardly show, because the decimation takes its time by the triangle.
        whole, best = whole.simplify(FIRST_MM), None
    count = min(whole.num_tri() // 2, MOST_FACETS)
    while best is None or count >= ENOUGH_FACETS:
        made = _fewer(whole, count, volume_mm3)
        if made is None:
            break
        far_mm = _apart_mm(exact, arrays(made))
        if best is not None and far_mm > WITHIN_MM:
            break
        whole, best, count = made, (*arrays(made), far_mm), count // 2
    if best is None:
        raise GeometryError(
            f"{what} has {len(faces)} triangles that cannot be thinned out to the "
            f"{MOST_FACETS} facets of a STEP file",
            hint="use its STL or 3MF file",
            at="mould",
        )
    return best


def _many(found: tuple[np.ndarray, np.ndarray, float]) -> bool:
    return len(found[1]) > MOST_FACETS


def _fewer(whole: Any, count: int, volume_mm3: float) -> Any | None:
    """A manifold of at most about so many facets, or None where there is none."""
    import pyvista

    points, faces = arrays(whole)
    padded = np.column_stack([np.full(len(faces), 3), faces]).ravel()
    surface = pyvista.PolyData(points, padded).decimate(
        1.0 - count / len(faces), volume_preservation=True
    )
    with contextlib.suppress(GeometryError):
        places = np.asarray(surface.points, np.float64)
        solid = closed("part", places, surface.regular_faces).simplify(CLEAN_MM)
        if len(solid.decompose()) == 1 and _writable(*arrays(solid), volume_mm3):
            return solid
    tolerance_mm = WITHIN_MM / 4
    while tolerance_mm <= 8 * WITHIN_MM:
        solid = whole.simplify(tolerance_mm)
        if solid.num_tri() <= count and _writable(*arrays(solid), volume_mm3):
            return solid
        tolerance_mm *= 2
    return None


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


def _apart_mm(exact: tuple[np.ndarray, np.ndarray], made: tuple[np.ndarray, np.ndarray]) -> float:
    """Largest distance between two surfaces, from the vertices and middles of either."""
    found = 0.0
    for (points, faces), (others, facets) in ((exact, made), (made, exact)):
        places = np.vstack([points, points[faces].mean(axis=1)])
        places = places[:: max(1, len(places) // PLACES)]
        found = max(found, float(distance_mm(others, facets, places).max()))
    return found
