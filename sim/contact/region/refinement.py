"""Contact points fine enough for the indenter: none may slip through between them.

Triangles that the indenter can come near are halved until every edge is shorter than 1.2 cells and
half the least radius of the indenter. Then those under the indenter in the first frame are halved
until at least `FEWEST_TOUCHING` corners lie inside it: a shallow first frame of a large ball
touches a spot smaller than any triangle. Neighbours of different fineness are allowed.
"""

from __future__ import annotations

import math

import numpy as np

from sim.contact.motion.approach import Approach
from sim.contact.region.halving import Halved, locate
from sim.contact.region.quadrature import Facets

LONGEST_EDGE = 1.2
"""Longest edge between contact points, in cells."""
EDGE_PER_RADIUS = 0.5
FINEST_EDGE = 0.1
"""Edges are not made shorter for a sharp indenter, in cells."""
FINEST_TOUCH_EDGE_MM = 0.005
MARGIN = 0.5
"""Gap to the indenter below which a triangle counts as near it, in cells."""
MOST_ADDED = 12_000
"""Triangles that halving may add at each of its two tasks."""
FEWEST_TOUCHING = 4
REACH_MARGIN_MM = 10.0
"""Places farther than this beyond the reach of the object only get a bound."""
LOOK_EVERY_MM = 1.0
"""Way of the object between two poses at which distances are looked at, besides all frames."""
MOST_LOOKS = 8
"""Poses of one frame at which distances are looked at."""


def path_samples(
    approach: Approach, *, every_mm: float = LOOK_EVERY_MM, most: int = MOST_LOOKS
) -> np.ndarray:
    """Progress [frames] at which a path is looked at: first touch, every frame, and between.

    Args:
        approach: The path.
        every_mm: Way of the object between two looks.
        most: Looks of one frame.
    """
    found = [np.zeros(1)]
    for frame in range(approach.frame_count):
        looks = math.ceil(approach.travel_mm(frame, 0.0) / every_mm)
        looks = min(max(looks, 1), most)
        found.append(frame + (np.arange(looks) + 1.0) / looks)
    return np.concatenate(found)


def path_distance_mm(places_mm: np.ndarray, approach: Approach) -> np.ndarray:
    """Least signed distance [mm] of undeformed places, (N, 3), over the path, shape (N,)."""
    nearest = np.full(len(places_mm), np.inf)
    for progress in path_samples(approach):
        nearest = np.minimum(nearest, distance_mm(places_mm, approach, float(progress)))
    return nearest


def refine(facets: Facets, approach: Approach, *, grid_mm: float) -> Facets:
    """Halve the triangles that the indenter comes near."""
    sharp_mm = max(EDGE_PER_RADIUS * approach.collider.least_radius_mm, FINEST_EDGE * grid_mm)
    longest_mm = min(LONGEST_EDGE * grid_mm, sharp_mm)
    most = len(facets.triangles) + MOST_ADDED
    while len(facets.triangles) < most:
        long = np.flatnonzero(facets.longest_edges_mm() > longest_mm)
        centre, radius = balls(facets.corners_mm()[long])
        gap = path_distance_mm(centre, approach) - radius
        near = long[gap < MARGIN * grid_mm]
        if not len(near):
            break
        # Each halving adds three triangles; with too many the nearest come first.
        room = max(1, (most - len(facets.triangles)) // 3)
        order = np.argsort(gap[gap < MARGIN * grid_mm], kind="stable")
        facets = facets.halve(near[order[:room]])
    return _refine_first_touch(facets, approach) if approach.deepest_mm else facets


def refine_within(facets: Facets, halved: Halved, *, grid_mm: float) -> Facets:
    """Halve the triangles in halved cells until each is as fine as the cells there."""
    for level in range(1, len(halved) + 1):
        longest_mm = LONGEST_EDGE * grid_mm * 0.5**level
        while True:
            centre = facets.corners_mm().mean(axis=1)
            inside = locate(centre / grid_mm, halved).level >= level
            long = np.flatnonzero(inside & (facets.longest_edges_mm() > longest_mm))
            if not len(long):
                break
            facets = facets.halve(long)
    return facets


def _refine_first_touch(facets: Facets, approach: Approach) -> Facets:
    """Halve the triangles under the indenter in the first frame until enough corners are inside."""
    most = len(facets.triangles) + MOST_ADDED
    while len(facets.triangles) < most:
        centre, radius = balls(facets.corners_mm())
        gap = distance_mm(centre, approach, 1.0) - radius
        under = np.flatnonzero((gap < 0.0) & (facets.longest_edges_mm() > FINEST_TOUCH_EDGE_MM))
        corners = np.unique(facets.triangles[gap < 0.0])
        inside = distance_mm(facets.points_mm[corners], approach, 1.0) < 0.0
        if np.count_nonzero(inside) >= FEWEST_TOUCHING or not len(under):
            break
        facets = facets.halve(under)
    return facets


def balls(corners_mm: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centroids [mm], (T, 3), and radii [mm], (T,), of balls that hold triangles."""
    centre = corners_mm.mean(axis=1)
    return centre, np.linalg.norm(corners_mm - centre[:, None], axis=2).max(axis=1)


def distance_mm(places_mm: np.ndarray, approach: Approach, progress: float) -> np.ndarray:
    """Signed distance of places, (N, 3), at a pose; for those beyond its reach a lower bound."""
    origin, rotation = approach.pose(progress)
    body = places_mm - origin
    distance = np.linalg.norm(body, axis=1) - approach.collider.reach_mm
    near = np.flatnonzero(distance < REACH_MARGIN_MM)
    distance[near] = approach.collider.distance(body[near] @ rotation)[0]
    return distance


def reach_mm(approach: Approach, grid_mm: float) -> float:
    """Gap to the path [mm] at which the bulging skin may still be met."""
    return 2.0 * grid_mm + 0.5 * approach.deepest_mm + 0.5 * approach.aside_mm
