"""A surface that is known, as a reading is to say it: depth and normal over each vertex at rest.

A reading moves each vertex along its inward normal at rest, so the truth is taken along the same
line: where it meets the displaced skin, less where it meets the same skin at rest. Skin that moves
sideways is then no error, nor is skin that stands elsewhere at rest: a built wall is thicker or
thinner than its design's.

`integrated_mm` is what known normals alone would give, a bound of any method that reads tilts: the
displacement h for which every edge of the moved mesh lies across the mean normal m of its ends,

    m . (x_j + h_j n_j - x_i - h_i n_i) = m0 . (x_j - x_i),

in least squares, with h = 0 around; m0 is the mean normal at rest.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.surface.rays import RayCaster
from sim.optics.raster.gbuffer import sum_area_vectors
from sim.reading.rest_skin import RestSkin

REACH_MM = 0.8
"""Above the vertex at rest, where lines begin: farther out they could begin beyond other skin."""
FARTHEST_MM = 6.0
"""Way along a line beyond which it met something else."""
ASIDE_MM = 1e-4
"""By which a line is moved that passes exactly between triangles."""


@dataclass(frozen=True, kw_only=True, slots=True)
class KnownSkin:
    """A skin at rest and displaced."""

    rest_mm: np.ndarray
    """Vertices, shape (W, 3)."""
    displaced_mm: np.ndarray
    """Likewise."""
    faces: np.ndarray
    """Shape (F, 3), counter-clockwise from outside."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TrueSurface:
    """Over V vertices of a reader's skin; NaN where their lines miss the known one."""

    depth_mm: np.ndarray
    """Inward, shape (V,)."""
    inward: np.ndarray
    """Unit normals of the displaced surface, shape (V, 3)."""
    rest_inward: np.ndarray
    """Those of the known surface at rest, shape (V, 3)."""


def surface_over(skin: RestSkin, known: KnownSkin) -> TrueSurface:
    """The known surface along the normals at rest."""
    away_mm, inward = _met(skin, known.displaced_mm, known.faces)
    rest_mm, rest_inward = _met(skin, known.rest_mm, known.faces)
    return TrueSurface(depth_mm=away_mm - rest_mm, inward=inward, rest_inward=rest_inward)


def integrated_mm(skin: RestSkin, surface: TrueSurface, free: np.ndarray) -> np.ndarray:
    """Displacement that the surface's normals alone give, shape (V,).

    Args:
        skin: The reader's.
        surface: Whose normals are known; unknown ones are left out.
        free: Vertices that may move, shape (V,), bool; the others stay.
    """
    from scipy.sparse import coo_matrix, eye
    from scipy.sparse.linalg import spsolve

    found = np.zeros(skin.count)
    edges = _edges(skin.faces)
    edges = edges[free[edges].any(axis=1)]
    means, before = (_mean(normals, edges) for normals in (surface.inward, surface.rest_inward))
    plain = np.isfinite(means).all(axis=1) & np.isfinite(before).all(axis=1)
    if not plain.any():
        return found
    edges, means, before = edges[plain], means[plain], before[plain]
    along = skin.points_mm[edges[:, 1]] - skin.points_mm[edges[:, 0]]
    wanted = np.einsum("ec,ec->e", before - means, along)
    one, two = (np.einsum("ec,ec->e", means, skin.inward[edges[:, end]]) for end in (0, 1))
    rows = np.arange(len(edges))
    matrix = coo_matrix(
        (np.concatenate([-one, two]), (np.concatenate([rows, rows]), edges.T.ravel())),
        (len(edges), skin.count),
    ).tocsc()[:, free]
    # Vertices whose normals are all unknown have no equation.
    square = matrix.T @ matrix + 1e-9 * eye(matrix.shape[1], format="csc")
    found[free] = np.asarray(spsolve(square.tocsc(), matrix.T @ wanted))
    return found


def _met(skin: RestSkin, points_mm: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Way from each vertex inward to a surface (V,), and its inward normal there (V, 3)."""
    points_mm = np.asarray(points_mm, dtype=np.float64)
    caster = RayCaster(points_mm, faces)
    begin = skin.points_mm - REACH_MM * skin.inward
    way, face, weights = caster.hits(begin, skin.inward)
    for one, two in ((1.0, 0.7), (-0.7, 1.0), (-1.0, -0.7), (0.7, -1.0)):
        missed = np.flatnonzero(face < 0)
        if len(missed):
            aside = ASIDE_MM * (one * skin.one[missed] + two * skin.two[missed])
            again = caster.hits(begin[missed] + aside, skin.inward[missed])
            way[missed], face[missed], weights[missed] = again
    hit = (face >= 0) & (way < FARTHEST_MM)
    outward = sum_area_vectors(points_mm, faces, len(points_mm))
    normal = np.full((skin.count, 3), np.nan)
    corners = outward[faces[face[hit]]]
    corners /= np.maximum(np.linalg.norm(corners, axis=2, keepdims=True), 1e-12)
    blended = -np.einsum("pk,pkc->pc", weights[hit], corners)
    normal[hit] = blended / np.maximum(np.linalg.norm(blended, axis=1, keepdims=True), 1e-12)
    return np.where(hit, way - REACH_MM, np.nan), normal


def _edges(faces: np.ndarray) -> np.ndarray:
    pairs = np.concatenate([faces[:, pair] for pair in ([0, 1], [1, 2], [2, 0])])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def _mean(normals: np.ndarray, edges: np.ndarray) -> np.ndarray:
    both = normals[edges].sum(axis=1)
    return both / np.maximum(np.linalg.norm(both, axis=1, keepdims=True), 1e-12)
