"""Descriptions of the mould's parts, in the local frame: x along the pull of the first part.

The body stands on its base plane with its tip up. The mould is used upside down: the flange is then
the lid, and the base of the body its highest place, so gate and vents end there.

         .-------+-------.     block: parts that meet on the parting surface,
         |    .-'|'-.    |     with ears that carry the keys and the bolts;
         |   /  .|.  \\   |     three or four parts make a round block
         |  |  | | |  |  |     core, one piece with the flange
      ._ |  |  | | |  |  | _.
      | ||__|__|_|_|__|__|| |  rim of the flange around the block
      |_____\\_/_______|_____|
             gate    vent
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry import csg
from geometry.cast import Cast
from geometry.channels import Channels
from geometry.parting import Parting
from geometry.trapped import POCKET_VENT_MM
from workbench.core.errors import DesignError
from workbench.core.making import MouldOptions

EAR_MM = 17.0
"""Room beside the body for a key and a bolt, with walls of 3 mm."""
KEY_OFFSET_MM = 5.5
BOLT_OFFSET_MM = 12.5
BOLT_RADIUS_MM = 1.7
"""Clearance hole of an M3 bolt. Source: ISO 273, medium fit 3.4 mm."""
HEAD_RADIUS_MM = 3.5
"""Half width of the flat seat of an M3 washer. Source: ISO 7089, 7 mm."""
GRIP_MM = 8.0
"""From the parting to the seat of a bolt in a round block [mm]."""
END_MM = 6.0
"""Height of the lowest key above the base [mm]."""
TALL_MM = 24.0
"""Blocks at least this high have two keys in each ear."""
FLANGE_MM = 6.0
RIM_WIDTH_MM = 3.0
RIM_HEIGHT_MM = 4.0
RIM_TO_BOLT_MM = 3.8
"""From the rim to the axis of a bolt [mm], so that its head goes past."""
THROAT_MM = 1.5
"""Straight part of the gate above its funnel [mm]."""
FUNNEL_EDGE_MM = 2.0
"""Least material between the funnel's mouth and the edge of the flange [mm]."""
KEY_ROOT_MM = 1.0
"""How deep a key is rooted in its own part [mm]."""
ACROSS = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0]])
"""Turns a prism along Z into one along -Y with its section in x and z, shape (3, 4)."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Key:
    """A cone that registers two parts."""

    base_mm: float
    tip_mm: float
    length_mm: float


STRAIGHT_KEY = Key(base_mm=2.5, tip_mm=1.5, length_mm=3.0)
"""Of two parts, which leave each other along the key."""
BLUNT_KEY = Key(base_mm=3.0, tip_mm=0.6, length_mm=2.0)
"""Of three or four parts, which leave each other at up to 45 degrees to the key; this has 50."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Layout:
    """What is made around the body, in the local frame."""

    low: np.ndarray
    """Lower corner of the body's bounding box [mm], shape (3,)."""
    high: np.ndarray
    """Upper corner, shape (3,)."""
    radius_mm: float
    """Largest distance of the body from the parting's middle."""
    parting: Parting
    options: MouldOptions

    @property
    def ear_mm(self) -> float:
        """Width of the block beside the body."""
        return max(EAR_MM, self.options.wall_mm)

    @property
    def half_mm(self) -> np.ndarray:
        """Half widths of the block in x and y [mm], shape (2,)."""
        if self.round:
            return np.full(2, self.radius_mm + self.ear_mm)
        margin = np.array([self.options.wall_mm, self.ear_mm])
        return (self.high - self.low)[:2] / 2 + margin

    @property
    def middle(self) -> np.ndarray:
        """Axis of the block, shape (2,)."""
        return self.parting.middle_mm

    @property
    def round(self) -> bool:
        """Whether the block is a cylinder."""
        return self.parting.count > 2

    @property
    def base_mm(self) -> float:
        """Height of the base plane [mm]."""
        return float(self.low[2])

    @property
    def top_mm(self) -> float:
        """Height of the block's top [mm]."""
        return float(self.high[2]) + self.options.wall_mm

    @property
    def bolt_mm(self) -> float:
        """Height of the bolts [mm]."""
        return (self.base_mm + self.top_mm) / 2

    @property
    def rim_mm(self) -> float:
        """Height of the rim over the base plane [mm]; low blocks leave room for the bolts."""
        return min(RIM_HEIGHT_MM, self.bolt_mm - self.base_mm - RIM_TO_BOLT_MM)


def make_layout(cast: Cast, parting: Parting, options: MouldOptions) -> Layout:
    """Sizes of the mould around a cast."""
    local = cast.outer.points_mm @ csg.turn_z(parting.azimuth_deg)
    return Layout(
        low=local.min(axis=0),
        high=local.max(axis=0),
        radius_mm=float(np.linalg.norm(local[:, :2] - parting.middle_mm, axis=1).max()),
        parting=parting,
        options=options,
    )


def outer_part(number: int, layout: Layout, outer: csg.Node, pockets_mm: np.ndarray) -> csg.Node:
    """One outer part: its piece of the block without the body, with keys, sockets and bolt holes.

    Args:
        outer: The body in the local frame.
        pockets_mm: Trapped air that this part lets out, local frame, shape (P, 3).
    """
    piece = _half(number, layout) if not layout.round else _wedge(number, layout)
    count, seams = layout.parting.count, _seams(layout)
    key = BLUNT_KEY if layout.round else STRAIGHT_KEY
    # Each seam joins two parts: keys on the one whose turn comes first, sockets in the other.
    mine = [seam for seam in seams if seam.first == number]
    theirs = [seam for seam in seams if (seam.first + 1) % count == number]
    sockets = [_key(key, spot, layout.options.clearance_mm) for s in theirs for spot in s.keys]
    bolts = [hole for seam in (*mine, *theirs) for hole in seam.bolts]
    # Keys first: joined to a plain block they cost the CAD kernel nothing, after the body much.
    keyed = csg.together(piece, [_key(key, spot, None) for seam in mine for spot in seam.keys])
    return csg.without(
        keyed, [outer, *sockets, *bolts, *air_holes(pockets_mm, layout, POCKET_VENT_MM)]
    )


def core_with_flange(layout: Layout, core: csg.Node | None, channels: Channels) -> csg.Node:
    """The core standing on a flange whose rim fits around the block, with gate and vents.

    Args:
        core: The core in the local frame; None for a flat lid.
        channels: Holes in the local frame.

    Raises:
        DesignError: If the gate's funnel is wider than the flange.
    """
    options, base = layout.options, layout.base_mm
    _check_gate(channels, layout)
    gap = options.clearance_mm
    plate = _slab(layout, gap + RIM_WIDTH_MM, base - FLANGE_MM, base + layout.rim_mm)
    pocket = _slab(layout, gap, base, base + layout.rim_mm + 1.0)
    low = base - FLANGE_MM
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
    flange = csg.without(csg.without(plate, [pocket]), holes)
    part = csg.together(flange, [] if core is None else [core])
    return csg.without(part, air_holes(channels.pockets_mm, layout, POCKET_VENT_MM))


@dataclass(frozen=True, kw_only=True, slots=True)
class Seam:
    """Where one part meets the next."""

    first: int
    """Number of the part that carries the keys."""
    keys: tuple[tuple[np.ndarray, np.ndarray], ...]
    """Place and direction of each key."""
    bolts: tuple[csg.Node, ...]


def _seams(layout: Layout) -> list[Seam]:
    if layout.round:
        return [_radial_seam(number, layout) for number in range(layout.parting.count)]
    reach = layout.half_mm[1] - layout.ear_mm
    inward = np.array([-1.0, 0.0, 0.0])
    keys, bolts = [], []
    for side in (-1.0, 1.0):
        y = layout.middle[1] + side * (reach + KEY_OFFSET_MM)
        for z in _key_heights(layout):
            keys.append((np.array([float(layout.parting.curve_x_mm(z)), y, z]), inward))
        y = layout.middle[1] + side * (reach + BOLT_OFFSET_MM)
        long = 2.0 * layout.half_mm[0]
        spot = np.array([layout.middle[0], y, layout.bolt_mm])
        bolts.append(csg.along(csg.cylinder(BOLT_RADIUS_MM, -long, long), inward, spot))
    return [Seam(first=0, keys=tuple(keys), bolts=tuple(bolts))]


def _radial_seam(number: int, layout: Layout) -> Seam:
    turn = np.radians(360.0 / layout.parting.count * (number + 0.5))
    outward = np.array([np.cos(turn), np.sin(turn), 0.0])
    onward = np.array([-np.sin(turn), np.cos(turn), 0.0])
    middle = np.array([*layout.middle, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    keys = tuple(
        (middle + (layout.radius_mm + KEY_OFFSET_MM) * outward + z * up, onward)
        for z in _key_heights(layout)
    )
    spot = middle + (layout.radius_mm + BOLT_OFFSET_MM) * outward + layout.bolt_mm * up
    far = 2.0 * float(layout.half_mm[0])
    hole = csg.along(csg.cylinder(BOLT_RADIUS_MM, -far, far), onward, spot)
    # Seats are notches open to the outside: a round one would leave slivers of the block.
    frame = np.column_stack([outward, -up, onward, spot])
    seats = [
        csg.Placed(
            body=csg.Box(
                low_mm=(-HEAD_RADIUS_MM, -HEAD_RADIUS_MM, low),
                high_mm=(far, HEAD_RADIUS_MM, high),
            ),
            matrix=frame,
        )
        for low, high in ((GRIP_MM, far), (-far, -GRIP_MM))
    ]
    bolts = (hole, *seats)
    return Seam(first=number, keys=keys, bolts=bolts)


def _key_heights(layout: Layout) -> list[float]:
    low, top = layout.base_mm, layout.top_mm
    return [low + END_MM, top - END_MM] if top - low >= TALL_MM else [(low + top) / 2]


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


def _key(key: Key, spot: tuple[np.ndarray, np.ndarray], gap_mm: float | None) -> csg.Node:
    """A key, or with a gap its socket. Both reach back through a sloping parting surface."""
    place, direction = spot
    gap = gap_mm or 0.0
    slope = (key.base_mm - key.tip_mm) / key.length_mm
    root = csg.Cone(
        low_radius_mm=key.base_mm + gap + slope * KEY_ROOT_MM,
        high_radius_mm=key.tip_mm + gap,
        low_mm=-KEY_ROOT_MM,
        high_mm=key.length_mm + gap,
    )
    return csg.along(root, direction, place)


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
    room = layout.half_mm + RIM_WIDTH_MM - offset
    limit_mm = 2 * (float(room.min()) - FUNNEL_EDGE_MM)
    if layout.options.gate_diameter_mm > limit_mm:
        raise DesignError(
            f"gate diameter {layout.options.gate_diameter_mm:g} mm is wider than the "
            f"{limit_mm:.1f} mm that the flange has room for",
            hint="lower mould.gate_diameter_mm or raise mould.wall_mm",
            at="mould.gate_diameter_mm",
        )
