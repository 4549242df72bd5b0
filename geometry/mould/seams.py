"""Where the outer parts of a mould meet: keys that register them and bolts that hold them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.body import csg
from geometry.mould.mould_layout import Layout

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
KEY_ROOT_MM = 1.0
"""How deep a key is rooted in its own part [mm]."""


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
class Seam:
    """Where one part meets the next."""

    first: int
    """Number of the part that carries the keys."""
    keys: tuple[tuple[np.ndarray, np.ndarray], ...]
    """Place and direction of each key."""
    bolts: tuple[csg.Node, ...]
    lugs: tuple[tuple[np.ndarray, np.ndarray], ...]
    """Place and direction along the seam of each lug of the flange, in x and y."""


def seams_of(layout: Layout) -> list[Seam]:
    """Every seam of the mould: two ears for halves, one per part of a round block."""
    if layout.round:
        return [_radial_seam(number, layout) for number in range(layout.parting.count)]
    reach = layout.half_mm[1] - layout.ear_mm
    inward = np.array([-1.0, 0.0, 0.0])
    keys, bolts, spots = [], [], []
    for side in (-1.0, 1.0):
        y = layout.middle[1] + side * (reach + KEY_OFFSET_MM)
        for z in _key_heights(layout):
            keys.append((np.array([float(layout.parting.curve_x_mm(z)), y, z]), inward))
        y = layout.middle[1] + side * (reach + BOLT_OFFSET_MM)
        long = 2.0 * layout.half_mm[0]
        spot = np.array([layout.middle[0], y, layout.bolt_mm])
        bolts.append(csg.along(csg.cylinder(BOLT_RADIUS_MM, -long, long), inward, spot))
        spots.append((spot[:2], np.array([0.0, side])))
    return [Seam(first=0, keys=tuple(keys), bolts=tuple(bolts), lugs=tuple(spots))]


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
    return Seam(first=number, keys=keys, bolts=bolts, lugs=((spot[:2], outward[:2]),))


def _key_heights(layout: Layout) -> list[float]:
    low, top = layout.base_mm, layout.top_mm
    return [low + END_MM, top - END_MM] if top - low >= TALL_MM else [(low + top) / 2]


def key_node(key: Key, spot: tuple[np.ndarray, np.ndarray], gap_mm: float | None) -> csg.Node:
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
