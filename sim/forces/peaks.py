"""Peaks of a contact that mean the same on every mesh: largest pressure, and largest disc force.

The force of a vertex grows with the area that the vertex stands for, so the largest says more of
the mesh than of the press. The traction T, force over area at the vertices and linear between
them, does not; nor does its integral over a disc of a fixed size,

    F(c) = | integral of T over the places of the skin at rest within d / 2 of c |,

whose largest value over the skin is the disc force: what a flat force gauge of that diameter would
read. Integrals are sums over patches of at most d / 12, those within a cube of that edge taken
together; what lies on the rim counts by a ramp as wide, which keeps the area of the disc. The best
centres are first sought with patches and cubes of d / 4, then about the best of these.

The disc is 2 mm wide, two cells of the published 0.9 mm mesh. Presses of 1 mm on the preset geltip
(ball of 6, cube of 5, cone of 6 mm) by finite elements on 0.9 mm against 0.45 mm read

    largest force of a vertex   +320 %   +263 %   +211 %
    disc of 1 mm                +4.8 %    +21 %    -21 %
    disc of 2 mm                +4.0 %    +13 %   -1.5 %
    all of the skin              +10 %     +7 %    +20 %
    largest pressure            +5.4 %    +11 %    -20 %

so that of 2 mm differs about as much as the presses themselves do; a disc of 1 mm is one cell. The
contact solver, whose skin has 0.4 mm, reads +0.5, -2.0 and -9 % against 0.45 mm (all of the skin:
-4, -6 and -11 %). Pressure under an edge or a point is as sharp as the mesh: see the disc there.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from geometry.surface.patches import cut
from geometry.surface.surface import vertex_areas_mm2, vertex_normals

DISC_MM = 2.0
"""Diameter of the disc."""
FINE = 1.0 / 12.0
"""Edge of patches and cubes over the disc's diameter."""
COARSE = 1.0 / 4.0
"""Edge of the cubes of the first search over the diameter."""
BEST_CUBES = 12
"""Cubes about which it is searched again."""
NEAR = 1.25
"""What may lie within a disc about a place of these cubes is nearer than this to them, over d."""
LEAST_SHARE = 1e-3
"""Vertices that carry less than this share of the largest force are left out."""
LEAST_MM2 = 1e-12


class Triangles(Protocol):
    """A skin at rest."""

    @property
    def points_mm(self) -> np.ndarray:
        """Vertices [mm], shape (V, 3)."""
        ...

    @property
    def faces(self) -> np.ndarray:
        """Triangles, shape (M, 3), counter-clockwise from outside."""
        ...


@dataclass(frozen=True, kw_only=True, slots=True)
class Peaks:
    """Of one state."""

    peak_MPa: float
    """Largest contact pressure at a vertex."""
    peak_disc_N: float
    """Largest force through a disc of `DISC_MM` anywhere on the skin at rest."""


def peaks(skin: Triangles, force_N: np.ndarray, moved_mm: np.ndarray) -> Peaks:
    """Peaks of the contact forces (V, 3) on a skin whose vertices moved by (V, 3)."""
    pressed = pressure_MPa(skin, force_N, moved_mm)
    return Peaks(
        peak_MPa=float(pressed.max(initial=0.0)),
        peak_disc_N=largest_disc_N(skin, force_N),
    )


def pressure_MPa(skin: Triangles, force_N: np.ndarray, moved_mm: np.ndarray) -> np.ndarray:
    """Force against the moved skin's normal per area at rest, shape (V,); 0 without force."""
    acting = _acting(skin, force_N)
    inward = -vertex_normals(skin.points_mm + moved_mm.astype(np.float64), acting)
    pressing_N = (force_N * inward).sum(axis=1)
    return pressing_N / np.maximum(vertex_areas_mm2(skin.points_mm, acting), LEAST_MM2)


def largest_disc_N(skin: Triangles, force_N: np.ndarray, *, disc_mm: float = DISC_MM) -> float:
    """Largest force through a disc anywhere on the skin at rest [N].

    Args:
        skin: At rest.
        force_N: Contact force of its vertices, shape (V, 3).
        disc_mm: Diameter of the disc.
    """
    from scipy.spatial import KDTree

    size_N = np.linalg.norm(force_N, axis=1)
    loaded_N = np.where((size_N > LEAST_SHARE * size_N.max(initial=0.0))[:, None], force_N, 0.0)
    acting = _acting(skin, loaded_N)
    if not len(acting):
        return 0.0
    area_mm2 = np.maximum(vertex_areas_mm2(skin.points_mm, acting), LEAST_MM2)
    traction_MPa = loaded_N / area_mm2[:, None]
    step_mm = COARSE * disc_mm
    places_mm, pull_N, parent = _carried(skin.points_mm, acting, traction_MPa, step_mm)
    middles_mm, sums_N = _gathered(places_mm, pull_N, step_mm)
    rough_N = _through_discs(middles_mm, (middles_mm, sums_N), disc_mm, step_mm)
    best = KDTree(middles_mm[np.argsort(rough_N)[-BEST_CUBES:]])
    near = acting[np.unique(parent[best.query(places_mm)[0] < NEAR * disc_mm])]
    places_mm, pull_N, _ = _carried(skin.points_mm, near, traction_MPa, FINE * disc_mm)
    fine = _gathered(places_mm, pull_N, FINE * disc_mm)
    centres_mm = fine[0][best.query(fine[0])[0] < step_mm]
    return float(_through_discs(centres_mm, fine, disc_mm, FINE * disc_mm).max())


def _carried(
    points_mm: np.ndarray, faces: np.ndarray, traction_MPa: np.ndarray, edge_mm: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Middles [mm] and forces [N] of patches of triangles, (S, 3), and each one's triangle."""
    patches = cut(points_mm, faces, edge_mm)
    pull_N = patches.at(traction_MPa) * patches.areas_mm2[:, None]
    return patches.at(points_mm), pull_N, patches.parent


def _acting(skin: Triangles, force_N: np.ndarray) -> np.ndarray:
    """Triangles at a vertex that carries force: all those that such vertices have, (N, 3)."""
    faces = np.asarray(skin.faces)
    loaded = np.asarray(force_N.any(axis=1))
    return faces[loaded[faces].any(axis=1)]


def _through_discs(
    centres_mm: np.ndarray,
    carried: tuple[np.ndarray, np.ndarray],
    disc_mm: float,
    ramp_mm: float,
) -> np.ndarray:
    """Size of the force [N] within each disc, shape (C,), of what is carried: places and forces.

    A ramp of width s about the radius R has the area pi (R^2 + s^2 / 12).
    """
    from scipy.spatial import KDTree

    places_mm, pull_N = carried
    reach_mm = np.sqrt(0.25 * disc_mm**2 - ramp_mm**2 / 12.0) + 0.5 * ramp_mm
    pairs = KDTree(centres_mm).sparse_distance_matrix(
        KDTree(places_mm), reach_mm, output_type="ndarray"
    )
    share = np.minimum((reach_mm - pairs["v"]) / ramp_mm, 1.0)[:, None]
    found_N = _sums(pairs["i"], share * pull_N[pairs["j"]], len(centres_mm))
    return np.linalg.norm(found_N, axis=1)


def _gathered(
    places_mm: np.ndarray, pull_N: np.ndarray, edge_mm: float
) -> tuple[np.ndarray, np.ndarray]:
    """Middles [mm] and forces [N] of the cubes that hold places, (C, 3) each."""
    cells = np.floor(places_mm / edge_mm).astype(np.int64)
    cells -= cells.min(axis=0)
    key = np.ravel_multi_index(tuple(cells.T), tuple(cells.max(axis=0) + 1))
    found, cube = np.unique(key, return_inverse=True)
    number = np.bincount(cube)[:, None]
    return _sums(cube, places_mm, len(found)) / number, _sums(cube, pull_N, len(found))


def _sums(owner: np.ndarray, values: np.ndarray, count: int) -> np.ndarray:
    """Sum of rows (S, 3) by owner, shape (count, 3)."""
    return np.column_stack([np.bincount(owner, values[:, k], count) for k in range(3)])
