"""B-rep parts of a two-part casting mould with a core, in the mould's own frame.

The body stands on z = 0 with its tip up; half A is pulled toward +X and half B toward -X. The
mould is used upside down: the flange is then the lid, and the base of the body its highest place,
so gate and vents end there, in the ring between outer body and core.

         .-------+-------.     block: half B | half A, with ears along +Y and -Y
         |    .-'|'-.    |     that carry the keys and the bolts
         |   /  .|.  \\   |
         |  |  | | |  |  |     core, one piece with the flange
      ._ |  |  | | |  |  | _.
      | ||__|__|_|_|__|__|| |  rim of the flange around the block
      |_____\\_/_______|_____|
             gate    vent
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.core.booleans import cut, fuse
from workbench.core.design import MouldOptions
from workbench.core.errors import DesignError

EAR_MM = 17.0
"""Room beside the body for a key and a bolt, with walls of 3 mm."""
KEY_OFFSET_MM = 5.5
KEY_BASE_MM = 2.5
KEY_TIP_MM = 1.5
KEY_LENGTH_MM = 3.0
KEY_ROOT_MM = 1.0
"""How deep the key is rooted in its own half [mm]."""
BOLT_OFFSET_MM = 12.5
BOLT_RADIUS_MM = 1.7
"""Clearance hole of an M3 bolt. Source: ISO 273, medium fit 3.4 mm."""
END_MM = 6.0
"""Height of the lowest key above the base [mm]."""
TALL_MM = 24.0
"""Blocks at least this high have two keys in each ear."""
FLANGE_MM = 6.0
RIM_WIDTH_MM = 3.0
RIM_HEIGHT_MM = 4.0
THROAT_MM = 1.5
"""Straight part of the gate above its funnel [mm]."""
LARGEST_THROAT_MM = 2.0
LARGEST_VENT_MM = 0.8
"""Vents wider than this would let silicone pour out."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Block:
    """Extent of the closed mould without its flange [mm]."""

    low: np.ndarray
    """Lower corner of the body's bounding box, shape (3,)."""
    high: np.ndarray
    """Upper corner, shape (3,)."""
    wall_mm: float

    @property
    def ear_mm(self) -> float:
        """Width of the block beside the body along Y."""
        return max(EAR_MM, self.wall_mm)

    @property
    def middle(self) -> np.ndarray:
        """Axis of the body in x and y, shape (2,)."""
        return (self.low[:2] + self.high[:2]) / 2

    @property
    def half_x_mm(self) -> float:
        """Half width of the block along X."""
        return float(self.high[0] - self.low[0]) / 2 + self.wall_mm

    @property
    def half_y_mm(self) -> float:
        """Half width of the block along Y, ears included."""
        return float(self.high[1] - self.low[1]) / 2 + self.ear_mm

    @property
    def height_mm(self) -> float:
        """Height of the block."""
        return float(self.high[2]) + self.wall_mm


@dataclass(frozen=True, kw_only=True, slots=True)
class Ring:
    """Places in the annulus between outer body and core where gate and vents end."""

    centres_mm: np.ndarray
    """x and y [mm], shape (1 + vents, 2); the first is the gate."""
    gap_mm: float
    """Narrowest width of the annulus there [mm]."""


def block_half(outer: Any, block: Block, options: MouldOptions, *, side: int) -> Any:
    """One outer half with keys (+1, half A) or their sockets (-1, half B) and bolt holes.

    Raises:
        GeometryError: If a boolean did not do what it should.
    """
    from build123d import Box, Pos

    x, y = block.middle
    width = block.half_x_mm
    body = Pos(x + side * width / 2, y, block.height_mm / 2) * Box(
        width, 2 * block.half_y_mm, block.height_mm
    )
    name = "half A" if side > 0 else "half B"
    half = cut(body, outer, what=f"the body from {name}")
    for place in _key_places(block):
        if side > 0:
            half = fuse(half, _key(place, 0.0, root_mm=KEY_ROOT_MM), what=f"key of {name}")
        else:
            half = cut(half, _key(place, options.clearance_mm), what=f"socket of {name}")
    for place in _bolt_places(block):
        half = cut(half, _bolt(place, 4 * width), what=f"bolt hole of {name}")
    return half


def core_with_flange(core: Any, block: Block, ring: Ring, options: MouldOptions) -> Any:
    """The core standing on a flange whose rim fits around the block, with gate and vents.

    Raises:
        DesignError: If the gate's funnel is wider than the flange.
        GeometryError: If a boolean did not do what it should.
    """
    from build123d import Box, Cone, Cylinder, Pos

    x, y = block.middle
    inside_x, inside_y = (
        half + options.clearance_mm for half in (block.half_x_mm, block.half_y_mm)
    )
    _check_gate(ring, block, options)
    height = FLANGE_MM + RIM_HEIGHT_MM
    plate = Pos(x, y, height / 2 - FLANGE_MM) * Box(
        2 * (inside_x + RIM_WIDTH_MM), 2 * (inside_y + RIM_WIDTH_MM), height
    )
    pocket = Pos(x, y, RIM_HEIGHT_MM) * Box(2 * inside_x, 2 * inside_y, 2 * RIM_HEIGHT_MM)
    part = fuse(cut(plate, pocket, what="pocket of the flange"), core, what="core on its flange")
    throat = min(0.45 * ring.gap_mm, LARGEST_THROAT_MM)
    vent = min(0.4 * ring.gap_mm, LARGEST_VENT_MM)
    for number, (hole_x, hole_y) in enumerate(ring.centres_mm):
        radius = vent if number else throat
        # Up to z = 0 and no farther: above it is the silicone, beside it the core.
        hole = Pos(hole_x, hole_y, -FLANGE_MM / 2) * Cylinder(radius, FLANGE_MM)
        part = cut(part, hole, what="vent" if number else "gate")
    mouth = options.gate_diameter_mm / 2
    if mouth > throat:
        depth = FLANGE_MM - THROAT_MM
        gate_x, gate_y = ring.centres_mm[0]
        funnel = Pos(gate_x, gate_y, -FLANGE_MM + depth / 2) * Cone(mouth, throat, depth)
        part = cut(part, funnel, what="funnel of the gate")
    return part


def _check_gate(ring: Ring, block: Block, options: MouldOptions) -> None:
    offset = np.abs(ring.centres_mm[0] - block.middle)
    room = np.array([block.half_x_mm, block.half_y_mm]) + RIM_WIDTH_MM - offset
    limit_mm = 2 * (float(room.min()) - 2.0)
    if options.gate_diameter_mm > limit_mm:
        raise DesignError(
            f"gate diameter {options.gate_diameter_mm:g} mm is wider than the {limit_mm:.1f} mm "
            "that the flange has room for",
            hint="lower mould.gate_diameter_mm or raise mould.wall_mm",
            at="mould.gate_diameter_mm",
        )


def _key_places(block: Block) -> list[tuple[float, float, float]]:
    top = block.height_mm
    heights = [END_MM, top - END_MM] if top >= TALL_MM else [top / 2]
    return [(x, y, z) for x, y in _beside(block, KEY_OFFSET_MM) for z in heights]


def _bolt_places(block: Block) -> list[tuple[float, float, float]]:
    return [(x, y, block.height_mm / 2) for x, y in _beside(block, BOLT_OFFSET_MM)]


def _beside(block: Block, offset_mm: float) -> list[tuple[float, float]]:
    x = float(block.middle[0])
    return [(x, float(block.low[1]) - offset_mm), (x, float(block.high[1]) + offset_mm)]


def _key(place: tuple[float, float, float], clearance_mm: float, *, root_mm: float = 0.0) -> Any:
    """A cone that points toward -X from the split plane, rooted `root_mm` behind it."""
    from build123d import Cone, Cylinder, Pos, Rot

    length = KEY_LENGTH_MM + clearance_mm
    base, tip = KEY_BASE_MM + clearance_mm, KEY_TIP_MM + clearance_mm
    turned = Pos(*place) * Rot(Y=-90)
    cone = turned * Pos(0, 0, length / 2) * Cone(base, tip, length)
    if root_mm == 0.0:
        return cone
    root = turned * Pos(0, 0, -root_mm / 2) * Cylinder(base, root_mm)
    return fuse(cone, root, what="root of a key")


def _bolt(place: tuple[float, float, float], length_mm: float) -> Any:
    from build123d import Cylinder, Pos, Rot

    return Pos(*place) * Rot(Y=90) * Cylinder(BOLT_RADIUS_MM, length_mm)
