"""What the LED ring's holder stands on where it floats above the base: a sleeve on the base.

The sleeve's plan is the first of three that carries the holder: a strip along the wall of the
cavity, which centres the support too; the outermost strip of the holder's own plan; all of that
plan. It keeps the clearance from the support over its whole height, so that the support slides over
it, stays clear of the camera module, and is opened like the holder, so that no wall of it is
thinner than `LEAST_WALL_MM`.

Nothing of it is nearer to the axis than the hole of the ring. Seen from a camera on the axis below
the ring, a thing at the same distance from the axis but lower is farther from the middle of the
view: the sleeve hides nothing that the holder does not. Leaves out: screws, holes for wires.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from geometry.body import csg
from geometry.body.csg_mesh import arrays
from geometry.housing.led_holder import LEAST_WALL_MM, Shells, heights, opened, prisms, shadow
from geometry.mould.castability import Worst
from geometry.surface.rays import RayCaster
from geometry.surface.spread import spread

ROOT_MM = 0.5
"""How deep the sleeve is rooted in the base [mm]."""
REST_MM = 0.1
"""Thickness of the slab in which plans are taken [mm]."""
PLAY_MM = 0.5
"""A support that can shift by less is centred [mm]."""
LIFT_MM = 0.01
TOUCH_MM3 = 1e-6
FACING_COSINE = 0.9
FARTHEST_MM = 50.0
"""Gaps wider than this are not measured [mm]."""


def holder_seat(
    holder: csg.Node,
    base: csg.Node,
    shells: Shells,
    keep_free: Sequence[csg.Node],
    *,
    hole_mm: float,
    wall_mm: float,
) -> list[csg.Node]:
    """The pieces of the sleeve from the base up to the holder; none if the base's top is high
    enough, or if there is no room for a sleeve that carries it.

    Args:
        holder: The finished holder.
        base: The foot with all its cuts.
        shells: Bodies beside which it stands; their gap is left below the holder too.
        keep_free: Rooms of camera module and mount.
        hole_mm: Radius of the ring's hole; 0 for a disc.
        wall_mm: Thickness of the sleeve.
    """
    import shapely

    gap_mm = shells.gap_mm
    top_mm, floor_mm = heights(holder)[0] - gap_mm, heights(base)[1]
    if top_mm <= floor_mm:
        return []
    ground = shadow(base, floor_mm - ROOT_MM, floor_mm)
    carried = shadow(holder, top_mm, top_mm + gap_mm + REST_MM)
    walls = [shadow(shell, floor_mm, top_mm + gap_mm) for shell in shells.bodies]
    wall = shapely.union_all(walls).buffer(gap_mm)
    free = _inside(wall) & ground
    for room in keep_free:
        free -= shadow(room, floor_mm - ROOT_MM, top_mm)
    if hole_mm > 0.0:
        free -= shapely.Point(0.0, 0.0).buffer(hole_mm)
    cavity = _filled(_inside(wall))
    outline = _filled(carried)
    plans = (
        cavity - cavity.buffer(-wall_mm),
        (outline - outline.buffer(-wall_mm)) & carried,
        carried,
    )
    for plan in plans:
        area = opened(plan & free, LEAST_WALL_MM)
        if _carries(area & carried, carried):
            return prisms(area, floor_mm - ROOT_MM, top_mm)
    return []


def seat_gap(holder: Any, base: Any) -> Worst:
    """How far the holder would fall until it stands on the base [mm], and its middle.

    It stands once its centroid, seen from above, is within the hull of what the base holds up.
    Rays go straight down from evenly spread places on the holder's underside.

    Args:
        holder: Manifold of the holder.
        base: Manifold of the base.
    """
    points, faces = arrays(holder)
    places = spread(points, faces)
    below = places.normals[:, 2] < -FACING_COSINE
    start = places.points_mm[below]
    middle = points.mean(axis=0) if not below.any() else start.mean(axis=0)
    place = (float(middle[0]), float(middle[1]), float(middle[2]))
    down = np.tile([0.0, 0.0, -1.0], (len(start), 1))
    distance, found, _ = RayCaster(*arrays(base)).hits(start, down)
    drop = np.where(found >= 0, distance, np.inf)
    order = np.argsort(drop, kind="stable")
    order = order[np.isfinite(drop[order])]
    few, many = 0, len(order) + 1
    # The hull only grows with the places: bisection finds the fewest that carry.
    while many - few > 1:
        count = (few + many) // 2
        few, many = (few, count) if _stands(start[order[:count]], middle) else (count, many)
    if many > len(order):
        return Worst(FARTHEST_MM, place)
    return Worst(min(float(drop[order[many - 1]]), FARTHEST_MM), place)


def centred(support: Any, others: Sequence[Any]) -> bool:
    """Whether holder or base stop the support, once shifted a little to any of four sides.

    Args:
        support: Manifold of the support.
        others: Manifolds of holder and base.
    """
    shifts = ((PLAY_MM, 0.0), (-PLAY_MM, 0.0), (0.0, PLAY_MM), (0.0, -PLAY_MM))
    # Lifted off the base by a hair: faces in one plane may share slivers.
    moved = [support.translate((x, y, LIFT_MM)) for x, y in shifts]
    return all(any((one ^ other).volume() > TOUCH_MM3 for other in others) for one in moved)


def _stands(places_mm: np.ndarray, middle_mm: np.ndarray) -> bool:
    import shapely

    hull = shapely.convex_hull(shapely.MultiPoint(places_mm[:, :2]))
    return bool(shapely.contains_xy(hull, middle_mm[0], middle_mm[1]))


def _carries(area: Any, carried: Any) -> bool:
    """Whether what stands on an area does not tip."""
    import shapely

    middle = carried.centroid
    return bool(shapely.contains_xy(shapely.convex_hull(area), middle.x, middle.y))


def _inside(wall: Any) -> Any:
    """What a wall encloses, seen from above; everything near if it encloses nothing."""
    enclosed = _filled(wall) - wall
    if enclosed.is_empty:
        return wall.buffer(FARTHEST_MM) - wall
    return enclosed


def _filled(area: Any) -> Any:
    """An area without its holes."""
    import shapely

    rings = [shapely.Polygon(part.exterior) for part in shapely.get_parts(area)]
    return shapely.union_all(rings)
