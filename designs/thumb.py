"""Thumb: it leans forward, flat in front and behind, with a nail let into the back of its tip.

Its pad (+Y) feels, its back (-Y) carries the nail: a field that arches across, sunk into the skin
between flanks, running out over the tip.

               .---.
             .'     `.      z = length_mm + tip_mm
      nail  /,        \\
           //          |
           ||   .--.   |    z = length_mm, root of the tip
      ____.'   |    |  |
       \\      |    |  /    z = straight_mm, the lean ends
        \\     |    | /      outside in: elastomer, support (rigid, clear), cavity
         \\   |    | /
       ___\\__|____|/____    z = 0, base plane
      |      |cam |      |
      |______|____|______|  z = -base_height_mm, the rigid foot
           <- depth ->      -Y to the left

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `width_mm`       | size along X                                                  |
| `depth_mm`       | size along Y at the base                                      |
| `corner_mm`      | radius of the section's corners, square to the lean           |
| `lean_deg`       | how far it leans toward +Y from the base on                   |
| `straight_mm`    | height at which the lean begins to give way                   |
| `length_mm`      | height at which the tip begins                                |
| `tip_mm`         | height of the tip above that                                  |
| `tip_lean_deg`   | how far the tip leans toward +Y                               |
| `taper`          | depth at the root of the tip over that at the base            |
| `tip_more_mm`    | how much thicker the elastomer is at the top of the tip       |
| `nail_mm`        | length of the nail below the root of the tip                  |
| `nail_width_mm`  | width of the nail's field                                     |
| `nail_ratio`     | depth of the nail at its lower end over the elastomer wall    |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

The body is a digit (`designs/digit.py`) with a core smaller by the wall. The nail takes away what
is behind y = Y(x, z), a parabola across that goes up along a straight line and falls off steeply
beside and below its field, so its volume is a quadrature.

Source of the defaults: measured on the released SimTac mesh of the thumb (MIT). Leaves out: the
fillets around the nail, a stiff nail of its own material.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.bodies import Bodies, Fields
from designs.digit import Digit, digit_body
from designs.nail import Nail, check_nail, without_nail
from designs.plates import bored_plate, rounded_prism
from designs.shells import hollow
from designs.sliders import slider
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers

MESH = "SimTac mesh"
CAVITY_MM = 2.5
"""Smallest half width of the cavity: room for a camera and LEDs [mm]."""
DOME_MM = 1.0
"""Lowest tip of the cavity [mm]."""
RISE_MM = 4.0
"""Least height over which the lean gives way [mm]."""
CORNER_SHARE = 0.95
"""Most of half a section that a corner may take."""
CORE_CORNER_MM = 0.5
"""Sharpest corner of a core [mm]: a printer's line."""
CROWN_SHARE = 0.1
"""Least depth where the sides of the rise would meet the plane of the top, over that at the root of
the tip: a tip with less is a blade."""
TARGET_RISE = 0.55
"""Height of the first press in the tip, over its own: lower the camera sees it aslant."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ThumbShape:
    """The thumb's own parameters."""

    width_mm: float = slider(27.0, (20.0, 40.0, 0.5), "mm", "Width", "Size along X", MESH)
    depth_mm: float = slider(
        22.6, (18.0, 36.0, 0.1), "mm", "Depth", "Size along Y at the base", MESH
    )
    corner_mm: float = slider(
        7.4, (3.0, 8.0, 0.1), "mm", "Corner radius", "Of the section, square to the lean", MESH
    )
    lean_deg: float = slider(
        22.0, (0.0, 25.0, 0.5), "degree", "Lean", "Toward the pad, from the base on", MESH
    )
    straight_mm: float = slider(
        16.5, (2.0, 30.0, 0.5), "mm", "Straight part", "Height where the lean gives way", MESH
    )
    length_mm: float = slider(
        30.0, (24.0, 60.0, 0.5), "mm", "Length", "From base to the root of the tip", MESH
    )
    tip_mm: float = slider(
        13.7, (10.0, 24.0, 0.1), "mm", "Tip height", "Of the rounded end above that", MESH
    )
    tip_lean_deg: float = slider(
        -4.0, (-10.0, 15.0, 0.5), "degree", "Tip lean", "Of the tip, toward the pad", MESH
    )
    taper: float = slider(
        0.92, (0.8, 1.0, 0.01), "", "Taper", "Depth at the root of the tip over the base's", MESH
    )
    tip_more_mm: float = slider(
        4.5, (0.0, 8.0, 0.5), "mm", "Thicker tip", "Elastomer at the top over that at the sides"
    )
    nail_mm: float = slider(
        8.0, (4.0, 14.0, 0.5), "mm", "Nail length", "From the root of the tip down the back", MESH
    )
    nail_width_mm: float = slider(
        15.4, (6.0, 18.0, 0.1), "mm", "Nail width", "Of the nail's field", MESH
    )
    nail_ratio: float = slider(
        0.4, (0.1, 0.45, 0.01), "", "Nail depth", "At its lower end, over the elastomer wall", MESH
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        3.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    def digit(self, inset_mm: float) -> Digit:
        """The body, or what hollows it, less by an inset and by more at the top."""
        lean, half = math.radians(self.lean_deg), (self.width_mm / 2, self.depth_mm / 2)
        corner = max(self.corner_mm - inset_mm, CORE_CORNER_MM)
        # Level sections of a leaning wall are thicker than the wall.
        return Digit(
            half_mm=(half[0] - inset_mm, half[1] - inset_mm / math.cos(lean)),
            corner_mm=(corner, corner / math.cos(lean)),
            root_mm=(half[0] - inset_mm, self.taper * half[1] - inset_mm),
            straight_mm=self.straight_mm,
            length_mm=self.length_mm,
            tip_mm=self.tip_mm - inset_mm - (self.tip_more_mm if inset_mm else 0.0),
            lean=math.tan(lean),
            tip_lean=math.tan(math.radians(self.tip_lean_deg)),
        )

    def nail(self, elastomer_mm: float) -> Nail:
        """The nail on the body, over a wall."""
        return Nail(
            digit=self.digit(0.0),
            low_mm=self.length_mm - self.nail_mm,
            width_mm=self.nail_width_mm,
            depth_mm=self.nail_ratio * elastomer_mm,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Thumb:
    """Builds thumbs."""

    name: str = "thumb"
    title: str = "Thumb"
    eye: tuple[float, float, float] = (1.6, -1.8, 0.9)
    """The nail is at -Y."""
    shape_type: type = ThumbShape

    def check(self, shape: ThumbShape, layers: Layers) -> None:
        """Refuse walls that leave no room inside, tips that are blades, nails that are none.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        _check_sizes(shape)
        _check_room(shape, layers)
        check_nail(shape.nail(layers.elastomer_mm), _core(shape, layers), layers.elastomer_mm)

    def soften(self, shape: ThumbShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: ThumbShape, layers: Layers) -> tuple[float, float, float]:
        """On the pad, in the middle of the tip."""
        z_mm = shape.length_mm + TARGET_RISE * shape.tip_mm
        middle, _, half, _, _ = shape.digit(0.0).sections(np.array([z_mm]))[0].tolist()
        return 0.0, middle + half, z_mm

    def build(self, shape: ThumbShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for.
        """
        self.check(shape, layers)
        whole = digit_body(shape.digit(0.0), what="outer body")
        outer = without_nail(whole, shape.nail(layers.elastomer_mm))
        core = digit_body(_core(shape, layers), what="core")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, digit_body(_cavity(shape, layers), what="cavity"), what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: ThumbShape, layers: Layers) -> Fields:
        """Digits and the nail as signed distance fields."""
        self.check(shape, layers)
        whole, core = shape.digit(0.0), _core(shape, layers)
        nail = shape.nail(layers.elastomer_mm)

        def outer(points_mm: np.ndarray) -> np.ndarray:
            return np.maximum(whole.distance(points_mm), -nail.distance(points_mm))

        low, high = whole.box_mm()
        return Fields(
            outer=outer,
            core=core.distance,
            cavity=_cavity(shape, layers).distance,
            base=_foot(shape, layers),
            wall_mm=min(layers.elastomer_mm, nail.wall_mm(core)),
            low_mm=low,
            high_mm=high,
        )


def _core(shape: ThumbShape, layers: Layers) -> Digit:
    return shape.digit(layers.elastomer_mm)


def _cavity(shape: ThumbShape, layers: Layers) -> Digit:
    return shape.digit(layers.elastomer_mm + layers.support_mm)


def _check_sizes(shape: ThumbShape) -> None:
    """Refuse parts of the body that leave each other no place."""
    if shape.straight_mm > shape.length_mm - RISE_MM:
        raise DesignError(
            f"the straight part of {shape.straight_mm:g} mm leaves less than {RISE_MM:g} mm up to "
            f"the root of the tip at {shape.length_mm:g} mm",
            hint="lower shape.straight_mm or raise shape.length_mm",
            at="shape.straight_mm",
        )
    depth_mm = shape.depth_mm * math.cos(math.radians(shape.lean_deg))
    limit_mm = CORNER_SHARE * min(shape.width_mm, depth_mm) / 2
    if shape.corner_mm > limit_mm:
        raise DesignError(
            f"corners of {shape.corner_mm:g} mm are more than {limit_mm:.3g} mm, {CORNER_SHARE:g} "
            "times half the width and half the depth square to the lean",
            hint="lower shape.corner_mm or raise shape.depth_mm or shape.width_mm",
            at="shape.corner_mm",
        )


def _check_room(shape: ThumbShape, layers: Layers) -> None:
    """Refuse walls that leave no room inside, and tips that are blades."""
    both_mm = layers.elastomer_mm + layers.support_mm
    cavity = _cavity(shape, layers)
    if cavity.tip_mm < DOME_MM:
        raise DesignError(
            f"a tip of {shape.tip_mm:g} mm less {both_mm:g} mm of support and elastomer wall and "
            f"{shape.tip_more_mm:g} mm more leaves {cavity.tip_mm:.3g} mm of cavity, less than "
            f"{DOME_MM:g} mm",
            hint="lower shape.tip_more_mm or layers.elastomer_mm, or raise shape.tip_mm",
            at="shape.tip_more_mm",
        )
    room_mm = min(*cavity.half_mm, *cavity.root_mm)
    if room_mm < CAVITY_MM:
        raise DesignError(
            f"support and elastomer wall together {both_mm:g} mm leave {room_mm:.3g} mm of cavity "
            f"on either side of its middle, less than {CAVITY_MM:g} mm",
            hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.width_mm, "
            "shape.depth_mm or shape.taper",
            at="layers.elastomer_mm",
        )
    for digit in (shape.digit(0.0), _core(shape, layers), cavity):
        share = float(digit.rows[2, 1, 3]) / digit.root_mm[1]
        if share < CROWN_SHARE:
            raise DesignError(
                f"a taper of {shape.taper:g} over {shape.length_mm - shape.straight_mm:g} mm goes "
                f"on to {share:.2g} of the tip's depth at its top, less than {CROWN_SHARE:g}",
                hint="raise shape.taper, or lower shape.straight_mm or shape.tip_mm",
                at="shape.taper",
            )


def _foot(shape: ThumbShape, layers: Layers) -> Any:
    """A rounded plate wider by the lip, with a bore for the camera."""
    lip = shape.base_lip_mm
    corner_mm = min(shape.corner_mm, CORNER_SHARE * min(shape.width_mm, shape.depth_mm) / 2) + lip
    width_mm, depth_mm = shape.width_mm + 2 * lip, shape.depth_mm + 2 * lip
    plate = rounded_prism(width_mm, depth_mm, corner_mm, -shape.base_height_mm, 0.0)
    return bored_plate(plate, min(_cavity(shape, layers).half_mm), shape.base_height_mm)


FAMILY = Thumb()
