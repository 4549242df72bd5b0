"""Where the contact is small against a cell, and which cells are halved for it.

A contact of a few cells is found only as well as it happens to lie on the lattice: under a cone of
0.45 mm a lattice moved by half a cell changes the force at 0.3 mm by 20 %. So at the end of each
increment, of which a path has as many in any number of frames, the part of the undeformed skin that
lies inside the object is measured: its half-width is that of the largest disc in it, and the
contact's is about 0.7 of that, as under a ball (sqrt(R d) of sqrt(2 R d)). Where a cell is more
than a third of the contact's width, cells around it are halved, at most twice. What touches the
skin only within an increment, or because a drive moves the skin, is not looked for, and no more
cells are added than `MOST_ADDED_SHARE` says.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from sim.contact.motion.approach import Approach
from sim.contact.motion.rests import rests
from sim.contact.region.halving import Halved, among, centres_mm, parents
from sim.contact.region.quadrature import Facets
from sim.contact.region.refinement import balls, distance_mm

CONTACT_SHARE = 0.7
"""Half-width of the contact over that of the overlap."""
CELLS_PER_HALF_WIDTH = 1.5
"""Least number of cells in the contact's half-width."""
SHARP_CELLS = 2.0
"""The same under an object whose sharpest part has a radius below a cell: pressure peaks there."""
MARGIN_CELLS = 1.5
"""Cells are halved so far around the overlap, in their own edges: a free node of the next level
needs halved cells on all sides."""
MOST_HALVINGS = 2
MOST_ADDED_SHARE = 0.6
"""Cells added over those of the region: a level that needs more is left coarse."""
FEWEST_INSIDE = 120
"""Corners inside the object from which an overlap is measured."""
FINEST_EDGE = 0.05
"""Triangles are not halved further for that, in cells."""
MOST_LOOKS = 20
"""Increments at whose ends an overlap is looked for."""


Within = Callable[[np.ndarray], np.ndarray]


class Overlap(NamedTuple):
    """The part of the undeformed skin inside the object."""

    places_mm: np.ndarray
    """Corners of triangles in it, shape (N, 3)."""
    half_width_mm: float
    finest_mm: float = 0.0
    """Edge of the cells that it asks for."""


def small_overlaps(facets: Facets, approach: Approach, *, grid_mm: float) -> list[Overlap]:
    """Overlaps at the ends of increments that are small against a cell."""
    ends = rests(approach)
    looks = np.unique(np.linspace(0, len(ends) - 1, min(len(ends), MOST_LOOKS)).round())
    found = [_overlap(facets, approach, float(ends[int(look)]), grid_mm) for look in looks]
    sharp = approach.collider.least_radius_mm < grid_mm
    cells = SHARP_CELLS if sharp else CELLS_PER_HALF_WIDTH
    asked = [each._replace(finest_mm=CONTACT_SHARE * each.half_width_mm / cells) for each in found]
    return [each for each in asked if len(each.places_mm) and each.finest_mm < grid_mm]


def _overlap(facets: Facets, approach: Approach, progress: float, grid_mm: float) -> Overlap:
    while True:
        centre, radius = balls(facets.corners_mm())
        reached = distance_mm(centre, approach, progress) < radius
        corners = np.unique(facets.triangles[reached])
        places = facets.points_mm[corners]
        inside = distance_mm(places, approach, progress) < 0.0
        long = facets.longest_edges_mm() > FINEST_EDGE * grid_mm
        if np.count_nonzero(inside) >= FEWEST_INSIDE or not (reached & long).any():
            return Overlap(places[inside], _half_width_mm(places, inside))
        nearer = replace(facets, triangles=facets.triangles[reached], parent=facets.parent[reached])
        facets = nearer.halve(np.arange(len(nearer.triangles)))


def _half_width_mm(places: np.ndarray, inside: np.ndarray) -> float:
    from scipy.spatial import KDTree

    if inside.all() or not inside.any():
        return np.inf if inside.any() else 0.0
    return float(KDTree(places[~inside]).query(places[inside])[0].max())


def halved_cells(
    overlaps: Sequence[Overlap], cells: np.ndarray, *, grid_mm: float, within: Within
) -> Halved:
    """Cells of each level to halve.

    Args:
        overlaps: Small ones.
        cells: Cells with material in the region, shape (M, 3).
        grid_mm: Edge of a cell of level 0.
        within: Whether cells may be halved, by their centres [mm].
    """
    halved: list[np.ndarray] = []
    added = 0
    for level in range(MOST_HALVINGS):
        small = [each.places_mm for each in overlaps if each.finest_mm < grid_mm * 0.5**level]
        if not small:
            break
        chosen = _around(np.concatenate(small), level, grid_mm)
        own = chosen
        if level:
            own = parents(chosen, level)
            chosen, own = (each[among(own, halved[-1])] for each in (chosen, own))
        chosen = chosen[within(centres_mm(chosen, level, grid_mm))]
        added += 7 * int(np.count_nonzero(among(own, cells)))
        if added > MOST_ADDED_SHARE * len(cells) or not len(chosen):
            break
        halved.append(chosen)
    return tuple(halved)


def _around(places_mm: np.ndarray, level: int, grid_mm: float) -> np.ndarray:
    """Cells of a level whose centres are near places, shape (Z, 3)."""
    from scipy.spatial import KDTree

    edge_mm, shift = grid_mm * 0.5**level, 0.5 if level else 0.0
    nearest = np.unique(np.round(places_mm / edge_mm - shift).astype(np.int64), axis=0)
    reach = int(np.ceil(MARGIN_CELLS)) + 1
    line = np.arange(-reach, reach + 1)
    box = np.stack(np.meshgrid(line, line, line, indexing="ij"), axis=-1).reshape(-1, 3)
    cells = np.unique((nearest[:, None] + box).reshape(-1, 3), axis=0)
    distance, _ = KDTree(places_mm).query(centres_mm(cells, level, grid_mm))
    return cells[distance < MARGIN_CELLS * edge_mm]
