"""Descriptions of the mould's parts, in the local frame: x along the pull of the first part.

The body stands on its base plane with its tip up. The mould is used upside down: the flange is then
the lid, and the base of the body its highest place, so gate and vents end there.

         .-------+-------.     block: parts that meet on the parting surface,
         |    .-'|'-.    |     with ears that carry the keys and the bolts;
         |   /  .|.  \\   |     three or four parts make a round block
         |  |  | | |  |  |     core, one piece with the flange
         |  |  | | |  |  |     lugs of the flange stand in the seams
      .__|__|__|_|_|__|__|__.
      |_____\\_/_______|_____|
             gate    vent
"""

from __future__ import annotations

import numpy as np

from geometry.body import csg
from geometry.mould.channels import Channels
from geometry.mould.lugs import lugs
from geometry.mould.mould_layout import Layout
from geometry.mould.seams import BLUNT_KEY, STRAIGHT_KEY, key_node, seams_of
from geometry.mould.trapped import POCKET_VENT_MM
from workbench.core.base.errors import DesignError

FLANGE_MM = 6.0
OVERHANG_MM = 3.0
"""How far the flange stands out from under the block, to be held by [mm]."""
THROAT_MM = 1.5
"""Straight part of the gate above its funnel [mm]."""
FUNNEL_EDGE_MM = 2.0
"""Least material between the funnel's mouth and the edge of the flange [mm]."""
ACROSS = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0]])
"""Turns a prism along Z into one along -Y with its section in x and z, shape (3, 4)."""


def outer_part(number: int, layout: Layout, outer: csg.Node, pockets_mm: np.ndarray) -> csg.Node:
    """One outer part: its piece of the block without the body, with keys, sockets and bolt holes.

    Args:
        outer: The body in the local frame.
        pockets_mm: Trapped air that this part lets out, local frame, shape (P, 3).
    """
    piece = _half(number, layout) if not layout.round else _wedge(number, layout)
    count, seams = layout.parting.count, seams_of(layout)
    key = BLUNT_KEY if layout.round else STRAIGHT_KEY
    # Each seam joins two parts: keys on the one whose turn comes first, sockets in the other.
    mine = [seam for seam in seams if seam.first == number]
    theirs = [seam for seam in seams if (seam.first + 1) % count == number]
    gap = layout.options.clearance_mm
    sockets = [key_node(key, spot, gap) for s in theirs for spot in s.keys]
    sockets += [lug for s in (*mine, *theirs) for lug in lugs(s.lugs, layout, gap)]
    bolts = [hole for seam in (*mine, *theirs) for hole in seam.bolts]
    # Keys first: joined to a plain block they cost the CAD kernel nothing, after the body much.
    keyed = csg.together(piece, [key_node(key, spot, None) for seam in mine for spot in seam.keys])
    return csg.without(
        keyed, [outer, *sockets, *bolts, *air_holes(pockets_mm, layout, POCKET_VENT_MM)]
    )


def core_with_flange(layout: Layout, core: csg.Node | None, channels: Channels) -> csg.Node:
    """The core standing on a flange with lugs that fit into the block, with gate and vents.

    Args:
        core: The core in the local frame; None for a flat lid.
        channels: Holes in the local frame.

    Raises:
        DesignError: If the gate's funnel is wider than the flange.
    """
    options, base = layout.options, layout.base_mm
    _check_gate(channels, layout)
    low = base - FLANGE_MM
    plate = _slab(layout, OVERHANG_MM, low, base)
    # Up to the base plane and no farther: above it is the silicone, beside it the core.
    holes = [_hole(place, channels.vent_mm, low, base) for place in channels.vents_mm]
    holes.append(_hole(channels.gate_mm, channels.throat_mm, low, base))
    mouth = options.gate_diameter_mm / 2
    if mouth > channels.throat_mm:
        funnel = csg.Cone(
            low_radius_mm=mouth,
            high_radius_mm=channels.throat_mm,
            low_mm=low,
            high_mm=base - THROAT_MM,
        )
        holes.append(csg.moved(funnel, (*channels.gate_mm, 0.0)))
    # Before the core joins: the CAD kernel is slow with its surface, and these do not meet it.
    found = [lug for seam in seams_of(layout) for lug in lugs(seam.lugs, layout, None)]
    flange = csg.without(csg.together(plate, found), holes)
    part = csg.together(flange, [] if core is None else [core])
    return csg.without(part, air_holes(channels.pockets_mm, layout, POCKET_VENT_MM))


def _half(number: int, layout: Layout) -> csg.Node:
    """The block on one side of the parting surface, as a prism along Y."""
    x, half = layout.middle[0], layout.half_mm
    bottom, top = layout.base_mm, layout.top_mm
    curve = layout.parting.curve_mm
    seam = np.vstack([[curve[0, 0], bottom], curve[1:-1], [curve[-1, 0], top]])
    far = x + half[0] if number == 0 else x - half[0]
    outline = np.vstack([seam, [[far, top], [far, bottom]]])
    if number == 0:
        outline = outline[::-1]
    middle_y = layout.middle[1]
    prism = csg.Prism(polygon_mm=outline, low_mm=-middle_y - half[1], high_mm=-middle_y + half[1])
    return csg.Placed(body=prism, matrix=ACROSS)


def _wedge(number: int, layout: Layout) -> csg.Node:
    """One sector of the round block."""
    count, radius = layout.parting.count, float(layout.half_mm[0])
    cylinder = csg.cylinder(radius, layout.base_mm, layout.top_mm)
    # Corners come from one list, so that neighbours share their planes to the last bit.
    turns = np.radians(180.0 / count * np.arange(2 * count))
    rays = 2.0 * radius * np.column_stack([np.cos(turns), np.sin(turns)])
    numbers = (2 * number + np.array([-1, 0, 1])) % (2 * count)
    sector = csg.Prism(
        polygon_mm=np.vstack([[0.0, 0.0], rays[numbers]]),
        low_mm=layout.base_mm - 1.0,
        high_mm=layout.top_mm + 1.0,
    )
    both = csg.Intersection(body=cylinder, other=sector)
    return csg.moved(both, (*layout.middle, 0.0))


def _slab(layout: Layout, margin_mm: float, low_mm: float, high_mm: float) -> csg.Node:
    """The block's outline with a margin, between two heights."""
    x, y = layout.middle
    half = layout.half_mm + margin_mm
    if layout.round:
        return csg.moved(csg.cylinder(float(half[0]), low_mm, high_mm), (x, y, 0.0))
    return csg.Box(
        low_mm=(x - half[0], y - half[1], low_mm), high_mm=(x + half[0], y + half[1], high_mm)
    )


def _hole(place: np.ndarray, radius_mm: float, low_mm: float, high_mm: float) -> csg.Node:
    return csg.moved(csg.cylinder(radius_mm, low_mm, high_mm), (*place, 0.0))


def air_holes(pockets_mm: np.ndarray, layout: Layout, into_mm: float) -> list[csg.Node]:
    """Thin holes from trapped air straight up (toward -Z) out of the mould.

    Args:
        into_mm: How far they reach into the cavity.
    """
    low = layout.base_mm - FLANGE_MM - 1.0
    return [_hole(spot[:2], POCKET_VENT_MM, low, spot[2] + into_mm) for spot in pockets_mm]


def _check_gate(channels: Channels, layout: Layout) -> None:
    offset = np.abs(channels.gate_mm - layout.middle)
    if layout.round:
        offset = np.full(2, np.linalg.norm(offset))
    room = layout.half_mm + OVERHANG_MM - offset
    limit_mm = 2 * (float(room.min()) - FUNNEL_EDGE_MM)
    if layout.options.gate_diameter_mm > limit_mm:
        raise DesignError(
            f"gate diameter {layout.options.gate_diameter_mm:g} mm is wider than the "
            f"{limit_mm:.1f} mm that the flange has room for",
            hint="lower mould.gate_diameter_mm or raise mould.wall_mm",
            at="mould.gate_diameter_mm",
        )
