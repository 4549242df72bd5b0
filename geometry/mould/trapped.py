"""Air that a cavity traps in pouring position, and whether a hole can let it out.

The mould is used upside down. Air stays wherever the cavity has a high place besides the base
plane: a local minimum of z on the cast's surface with material above it. How much a place traps is
how far z must rise from it to get around (its persistence in the merge tree of the surface;
Edelsbrunner and Harer, Computational Topology, 2010, chapter VII). Vertices joined by level edges
are one place, so that the flat tip of a pin is looked at as a whole: its air gathers anywhere on
it, and its hole belongs in its middle.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from geometry.body.csg import Body
from geometry.mould.cast import Cast
from geometry.surface.rays import RayCaster

POCKET_VENT_MM = 0.3
"""Radius of a hole that lets trapped air out [mm]; its skin is cut off the cast."""
LEAST_POCKET_MM = 0.3
"""Air higher than this counts as trapped [mm]; lower is rounding of edges and facets."""
LEVEL_MM = 1e-6
"""Ends of an edge that differ by less in height are level [mm]."""
ASIDE_MM = 1e-3


class Pockets(NamedTuple):
    """High places of a cavity that air cannot leave."""

    places_mm: np.ndarray
    """Shape (P, 3)."""
    height_mm: np.ndarray
    """How high the air stands in each [mm], shape (P,)."""


def pockets(cast: Cast) -> Pockets:
    """High places of the cavity, seen in pouring position, that are not the base plane."""
    found = _pockets_of(cast.outer, cast.base_mm, roof=False)
    if cast.core is None:
        return found
    others = _pockets_of(cast.core, cast.base_mm, roof=True)
    return Pockets(
        np.concatenate([found.places_mm, others.places_mm]),
        np.concatenate([found.height_mm, others.height_mm]),
    )


def _pockets_of(body: Body, base_mm: float, *, roof: bool) -> Pockets:
    """Local minima of z of a body's surface where the cast lies above.

    The cast lies inside the outer body, but outside the core (`roof`): there the wanted minima are
    dents in the core's top, which look up.
    """
    points, faces = body.points_mm, np.asarray(body.faces)
    level = _levels(points[:, 2], faces)
    height_mm = np.bincount(level, points[:, 2]) / np.bincount(level)
    lowest, rise = _persistent_minima(height_mm, level[faces])
    wanted = (rise > LEAST_POCKET_MM) & (height_mm[lowest] > base_mm + LEAST_POCKET_MM)
    lowest, rise = lowest[wanted], rise[wanted]
    places, upward = _middles(points, faces, level, lowest)
    facing = upward if roof else ~upward
    return Pockets(places[facing], rise[facing])


def _levels(z_mm: np.ndarray, faces: np.ndarray) -> np.ndarray:
    """Number of the level piece of surface that each vertex belongs to, shape (N,), from 0."""
    from scipy.sparse import coo_matrix
    from scipy.sparse.csgraph import connected_components

    start, stop = faces.ravel(), np.roll(faces, 1, axis=1).ravel()
    flat = np.abs(z_mm[start] - z_mm[stop]) < LEVEL_MM
    shape = (len(z_mm), len(z_mm))
    links = coo_matrix((np.ones(int(flat.sum())), (start[flat], stop[flat])), shape)
    return connected_components(links, directed=False)[1]


def _middles(
    points_mm: np.ndarray, faces: np.ndarray, level: np.ndarray, chosen: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Middle of each chosen level piece, shape (P, 3), and whether it looks up, shape (P,).

    Both of its own facets; a single vertex or edge has none, and those around it decide.
    """
    corners = points_mm[faces]
    middle = corners.mean(axis=1)
    normal_z = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    members = level[faces]
    places, upward = np.zeros((len(chosen), 3)), np.zeros(len(chosen), dtype=bool)
    for k, piece in enumerate(chosen):
        own = (members == piece).all(axis=1)
        around = own if own.any() else (members == piece).any(axis=1)
        upward[k] = normal_z[around].sum() > 0.0
        places[k] = points_mm[level == piece].mean(axis=0)
        if own.any():
            area = np.abs(normal_z[own])
            centroid = area @ middle[own] / area.sum()
            # The centroid of a ring is not on it; then the middle of the facet nearest to that.
            away = np.linalg.norm(middle[own] - centroid, axis=1)
            inside = _covered(corners[own][:, :, :2], centroid[:2])
            places[k] = centroid if inside else middle[own][np.argmin(away)]
    return places, upward


def _covered(triangles: np.ndarray, place: np.ndarray) -> bool:
    """Whether a place of the plane lies in any of the triangles, shape (F, 3, 2)."""
    ahead = np.roll(triangles, -1, axis=1) - triangles
    toward = place - triangles
    side = ahead[:, :, 0] * toward[:, :, 1] - ahead[:, :, 1] * toward[:, :, 0]
    # A hair of tolerance, or a place on the edge between two triangles could be in neither.
    slack = 1e-9 * (1.0 + np.abs(side).max())
    return bool(((side >= -slack).all(axis=1) | (side <= slack).all(axis=1)).any())


def _persistent_minima(z_mm: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Nodes that are local minima, and the rise to the pass toward a lower one (merge tree).

    Args:
        z_mm: Height of each node.
        faces: Triangles of nodes; corners may coincide.
    """
    from scipy.sparse import coo_matrix

    count = len(z_mm)
    start, stop = faces.ravel(), np.roll(faces, 1, axis=1).ravel()
    links = coo_matrix((np.ones(len(start)), (start, stop)), (count, count)).tocsr()
    order = np.argsort(z_mm, kind="stable")
    rank = np.empty(count, dtype=np.int64)
    rank[order] = np.arange(count)
    parent = list(range(count))

    def root(node: int) -> int:
        while parent[node] != node:
            parent[node] = parent[parent[node]]
            node = parent[node]
        return node

    rise = {}
    ranks = [int(number) for number in rank]
    begin = [int(number) for number in links.indptr]
    near = [int(number) for number in links.indices]
    for node in order.tolist():
        lower = {root(n) for n in near[begin[node] : begin[node + 1]] if ranks[n] < ranks[node]}
        if not lower:
            continue
        oldest = min(lower, key=ranks.__getitem__)
        for other in lower - {oldest}:
            rise[other] = float(z_mm[node] - z_mm[other])
            parent[other] = oldest
        parent[node] = oldest
    return np.array(list(rise), dtype=np.int64), np.array(list(rise.values()))


def can_leave(cast: Cast, places_mm: np.ndarray) -> np.ndarray:
    """Whether a hole toward -Z from each place meets nothing of the cast, shape (P,), bool."""
    if not len(places_mm):
        return np.zeros(0, dtype=bool)
    bodies = [cast.outer] if cast.core is None else [cast.outer, cast.core]
    free = np.ones(len(places_mm), dtype=bool)
    around = [(0.0, 0.0)] + [
        (POCKET_VENT_MM * np.cos(turn), POCKET_VENT_MM * np.sin(turn))
        for turn in np.radians([0.5, 90.5, 180.5, 270.5])
    ]
    above = cast.base_mm + LEAST_POCKET_MM
    for x, y in around:
        start = places_mm + np.array([x + ASIDE_MM, y + ASIDE_MM, -LEAST_POCKET_MM / 2])
        down = np.tile([0.0, 0.0, -1.0], (len(start), 1))
        for body in bodies:
            hits = RayCaster(body.points_mm, body.faces).hits(start, down)[0]
            # The base plane caps the bodies; meeting it is leaving.
            free &= start[:, 2] - hits < above
    return free
