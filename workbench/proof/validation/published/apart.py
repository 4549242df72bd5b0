"""How far two skins lie apart, and what an ellipsoid would score.

Distances are those of evenly spread places of either skin to the other one, both taken together.
Places of ours that lie flat in a cut of the released one are left out: it has nothing there.
"""

from __future__ import annotations

import numpy as np

from geometry.surface.primitives import sphere
from geometry.surface.spread import spread
from geometry.surface.surface import closest_point
from workbench.proof.validation.published.released import Cut, Skin

PLACES = 4000
"""On either skin: one for less than a square millimetre of all but the arm."""
IN_CUT_MM, IN_CUT_COSINE = 0.5, 0.95
"""How near to a cut, and how parallel to it, a face is taken for part of the cut."""


def distances_mm(ours: Skin, released: Skin) -> np.ndarray:
    """Of places of ours to the released skin, and the other way, shape (2 PLACES or fewer,)."""
    here = spread(ours.points_mm, ours.faces, PLACES)
    there = spread(released.points_mm, released.faces, PLACES)
    kept = ~in_cuts(here.points_mm, here.normals, released.cuts)
    to_released = closest_point(released.points_mm, released.faces, here.points_mm[kept])[1]
    to_ours = closest_point(ours.points_mm, ours.faces, there.points_mm)[1]
    return np.concatenate([to_released, to_ours])


def in_cuts(points_mm: np.ndarray, normals: np.ndarray, cuts: tuple[Cut, ...]) -> np.ndarray:
    """Which places lie flat in one of the cuts, shape (N,), bool."""
    found = np.zeros(len(points_mm), dtype=bool)
    for cut in cuts:
        near = np.abs(points_mm @ cut.way - cut.offset_mm) < IN_CUT_MM
        found |= near & (np.abs(normals @ cut.way) > IN_CUT_COSINE)
    return found


def ellipsoid(released: Skin) -> Skin:
    """The ellipsoid that fills the box of a skin."""
    low, high = released.points_mm.min(axis=0), released.points_mm.max(axis=0)
    points, faces = sphere(1.0)
    return Skin(points_mm=0.5 * (low + high) + 0.5 * (high - low) * points, faces=faces)
