"""The LED ring's holder where the plain one would leave slivers: a stack of opened sections.

Cutting a ring by shell, camera and pockets leaves knife edges wherever two cuts nearly meet. So the
ring is drawn from above instead, in slabs between the heights where something begins or ends. In
each slab what must be free is taken from the ring's plan, and the plan is opened by a disc of the
least wall: erosion, then dilation. What remains is a union of such discs, so no wall of it is
thinner; a pocket or a cut that nearly breaks through so becomes open to that side.

Slabs never end within the least wall of each other above or below the camera: its room is then cut
up to the next slab, or through. Source: Serra, Image Analysis and Mathematical Morphology, 1982
(opening). Leaves out: walls between the slanted pockets of tilted LEDs and the outside.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np

from geometry.body import csg
from geometry.body.csg_mesh import evaluate

CHORD_MM = 0.005
"""Corners that stand out of their outline by less are left away [mm]."""
SPARE_MM = 0.02
"""What the opening disc is wider than the least wall [mm]: its outline has chords."""
ARC_CHORDS = 6
"""Of a quarter of that disc: its outline then is good to 4 micrometres."""
CRUMB_MM2 = 0.5
UPRIGHT_DEG = 1.0
LEAST_WALL_MM = 0.8
"""Thinnest printed wall of a part that carries no bolts: two lines of a 0.4 mm nozzle [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Shells:
    """Membrane and support, beside which a gap stays free."""

    bodies: tuple[csg.Node, ...]
    gap_mm: float


def shaped_holder(
    ring: csg.Node,
    shells: Shells,
    module: csg.Node,
    pockets: Sequence[csg.Node],
    *,
    wall_mm: float,
    tilt_deg: float,
) -> csg.Node | None:
    """The holder whose sections have no wall thinner than `wall_mm`; None if nothing remains.

    Args:
        ring: The uncut ring.
        shells: Bodies beside which it stands.
        module: Room of the camera module with its gap.
        pockets: Room of each LED with its gap, open to the front.
        tilt_deg: Of the LEDs; the pockets of upright ones are part of the plan.
    """
    low_mm, top_mm = heights(ring)
    gap_mm = shells.gap_mm
    upright = abs(tilt_deg) < UPRIGHT_DEG
    floor_mm = min(heights(pocket)[0] for pocket in pockets) if upright else top_mm
    module_mm = _module_top(heights(module)[1], floor_mm, top_mm, wall_mm)
    plan = shadow(ring, low_mm, top_mm)
    for shell in shells.bodies:
        plan -= shadow(shell, low_mm - gap_mm, top_mm + gap_mm).buffer(gap_mm)
    levels = [low_mm, *(z for z in sorted({floor_mm, module_mm}) if low_mm < z < top_mm), top_mm]
    slabs: list[csg.Node] = []
    for bottom, end in pairwise(levels):
        area = plan
        if bottom < module_mm:
            area -= shadow(module, low_mm, top_mm)
        if bottom >= floor_mm:
            for pocket in pockets:
                area -= shadow(pocket, floor_mm, top_mm)
        slabs += prisms(opened(area, wall_mm), bottom, end)
    if not slabs:
        return None
    stack = csg.together(slabs[0], slabs[1:])
    return stack if upright else csg.without(stack, pockets)


def _module_top(module_mm: float, floor_mm: float, top_mm: float, wall_mm: float) -> float:
    """How high the camera's room is cut [mm], so that no skin thinner than the wall is over it."""
    if module_mm < floor_mm < module_mm + wall_mm:
        module_mm = floor_mm
    return top_mm if module_mm > top_mm - wall_mm else module_mm


def heights(node: csg.Node) -> tuple[float, float]:
    """Lowest and highest point of a body [mm]."""
    box = evaluate(node).bounding_box()
    return float(box[2]), float(box[5])


def shadow(node: csg.Node, low_mm: float, high_mm: float) -> Any:
    """A body between two heights, seen from above, as a shapely area."""
    import shapely

    solid = evaluate(node).trim_by_plane((0.0, 0.0, 1.0), low_mm)
    outlines = solid.trim_by_plane((0.0, 0.0, -1.0), -high_mm).project().to_polygons()
    area = shapely.Polygon()
    for outline in outlines:
        area = area.symmetric_difference(shapely.Polygon(outline).buffer(0.0))
    return area


def opened(area: Any, wall_mm: float) -> Any:
    """The union of all discs of diameter `wall_mm` in an area; crumbs of 0.5 mm2 left away."""
    import shapely

    radius_mm = (wall_mm + SPARE_MM) / 2
    kept = area.buffer(-radius_mm).buffer(radius_mm, quad_segs=ARC_CHORDS).simplify(CHORD_MM)
    found = [part for part in shapely.get_parts(kept) if part.area > CRUMB_MM2]
    return shapely.MultiPolygon(found)


def prisms(area: Any, low_mm: float, high_mm: float) -> list[csg.Node]:
    """One body for each piece of an area, extruded."""
    import shapely

    found = []
    for part in shapely.get_parts(area):
        part = shapely.geometry.polygon.orient(part)
        holes = [
            csg.Prism(
                polygon_mm=np.array(hole.coords)[-2::-1], low_mm=low_mm - 1.0, high_mm=high_mm + 1.0
            )
            for hole in part.interiors
        ]
        outline = np.array(part.exterior.coords)[:-1]
        body = csg.Prism(polygon_mm=outline, low_mm=low_mm, high_mm=high_mm)
        found.append(csg.without(body, holes))
    return found
