"""Where silicone goes in and air goes out: gate, vents and trapped air.

The mould is used upside down. The cast's face on the base plane is then its highest place: gate and
vents end there, on the medial axis of that face (corners of the Voronoi cells of its outline), the
gate where there is most room, each vent as far from all others as it can be.

Air stays wherever the cavity has another high place: a local minimum of z on the cast's surface
with material above it. How much a place traps is how far z must rise from it to get around (its
persistence in the merge tree of the surface; Edelsbrunner and Harer, Computational Topology, 2010,
chapter VII). Places that trap more than 0.3 mm get a thin hole straight up (toward -Z) through the
mould where nothing of the cast is in the way; the others are reported.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from geometry.cast import Cast, footprint
from geometry.csg import Body
from geometry.rays import RayCaster
from workbench.core.errors import GeometryError

GATE_GAP_SHARE = 0.9
"""Width of the gate's throat over the room it ends in."""
VENT_GAP_SHARE = 0.8
LARGEST_THROAT_MM = 2.0
"""Radius [mm]."""
LARGEST_VENT_MM = 0.8
"""Radius of a vent [mm]; wider ones would let silicone pour out."""
POCKET_VENT_MM = 0.3
"""Radius of a hole that lets trapped air out [mm]; its skin is cut off the cast."""
LEAST_POCKET_MM = 0.3
"""Air higher than this counts as trapped [mm]; lower is rounding of edges and facets."""
OUTLINE_STEP_MM = 0.4
ROOMY_SHARE = 0.6
"""Places with at least this share of the gate's room may get a vent."""
EQUAL_SHARE = 0.97
"""Places with this share of the most room are as good a gate."""
ASIDE_MM = 1e-3
MOST_POCKETS = 64


@dataclass(frozen=True, kw_only=True, slots=True)
class Channels:
    """Holes of the mould, in the sensor frame."""

    gate_mm: np.ndarray
    """x and y of the gate [mm], shape (2,)."""
    throat_mm: float
    """Radius of the gate where it ends [mm]."""
    vents_mm: np.ndarray
    """x and y of the vents [mm], shape (V, 2)."""
    vent_mm: float
    """Radius of the vents [mm]."""
    pockets_mm: np.ndarray
    """Trapped air that gets a hole straight up, shape (P, 3)."""
    trapped_mm: np.ndarray
    """Trapped air that nothing lets out, shape (Q, 3)."""
    trapped_height_mm: float
    """Highest air that nothing lets out [mm]; 0 when there is none."""


class Pockets(NamedTuple):
    """High places of a cavity that air cannot leave."""

    places_mm: np.ndarray
    """Shape (P, 3)."""
    height_mm: np.ndarray
    """How high the air stands in each [mm], shape (P,)."""


def make_channels(cast: Cast, vent_count: int) -> Channels:
    """Gate, vents and holes for trapped air of a cast.

    Raises:
        GeometryError: If the cast has no face on the base plane.
    """
    places, room = medial_points(cast)
    order = np.lexsort((-places[:, 0], -places[:, 1]))
    places, room = places[order], room[order]
    # Of equally roomy places the one farthest along +Y, so that the answer has one reason.
    gate = int(np.flatnonzero(room >= EQUAL_SHARE * room.max())[0])
    vents = _far_apart(places, room, gate, vent_count)
    found = pockets(cast)
    free = _can_leave(cast, found.places_mm)
    free[MOST_POCKETS:] = False
    return Channels(
        gate_mm=places[gate],
        throat_mm=min(GATE_GAP_SHARE * float(room[gate]), LARGEST_THROAT_MM),
        vents_mm=places[vents],
        vent_mm=min(VENT_GAP_SHARE * float(room[vents].min()), LARGEST_VENT_MM),
        pockets_mm=found.places_mm[free],
        trapped_mm=found.places_mm[~free],
        trapped_height_mm=float(found.height_mm[~free].max(initial=0.0)),
    )


def medial_points(cast: Cast) -> tuple[np.ndarray, np.ndarray]:
    """Places midway between outlines of the cast on the base plane, and the room around each.

    Returns:
        x and y [mm], shape (N, 2); distance to the outline [mm], shape (N,).
    """
    import shapely
    from scipy.spatial import Voronoi

    area = footprint(cast)
    if area.area <= 0.0:
        raise GeometryError(
            "the body has no face on its base plane, so nothing can be poured in",
            hint="cut the body flat at z = 0",
            at="shape",
        )
    outline = shapely.get_coordinates(shapely.segmentize(area.boundary, OUTLINE_STEP_MM))
    corners = Voronoi(np.unique(outline, axis=0)).vertices
    shapely.prepare(area)
    inside = shapely.contains_xy(area, corners[:, 0], corners[:, 1])
    room = np.asarray(shapely.distance(area.boundary, shapely.points(corners[inside])))
    return corners[inside], room


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
    corners = points[faces]
    normal_z = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])[:, 2]
    upward = np.bincount(faces.ravel(), np.repeat(normal_z, 3), len(points))
    lowest, height = _persistent_minima(points[:, 2], faces)
    facing = upward[lowest] > 0.0 if roof else upward[lowest] < 0.0
    wanted = facing & (height > LEAST_POCKET_MM) & (points[lowest, 2] > base_mm + LEAST_POCKET_MM)
    return Pockets(points[lowest[wanted]], height[wanted])


def _persistent_minima(z_mm: np.ndarray, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices that are local minima, and the rise to the pass toward a lower one (merge tree)."""
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


def _can_leave(cast: Cast, places_mm: np.ndarray) -> np.ndarray:
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


def _far_apart(places: np.ndarray, room: np.ndarray, first: int, count: int) -> list[int]:
    """Numbers of places, each as far as possible from the first and from all before it."""
    allowed = np.flatnonzero(room >= ROOMY_SHARE * room[first])
    nearest = np.linalg.norm(places[allowed] - places[first], axis=1)
    chosen = []
    for _ in range(count):
        # Rounded, so that equally far places are told apart by their order, not by noise.
        best = int(np.argmax(np.round(nearest, 2)))
        chosen.append(int(allowed[best]))
        distance = np.linalg.norm(places[allowed] - places[chosen[-1]], axis=1)
        nearest = np.minimum(nearest, distance)
    return chosen
