"""Thumb: a bent, flattened finger with a nail.

Its pad (+Y) feels, its back (-Y) carries the nail: a flat facet cut into the skin, where a stiff
plate may be glued.

              .--.
            .'    `.        z = length_mm + tip_mm
      nail /|       \\
          | |        |  ->  the centre line bends toward +Y by bend_mm at length_mm
          | |  .--.  |
          \\_| |    | |
           |  |    | |      outside in: elastomer, support (rigid, clear), cavity
           |  |    | |
       ____|__|____|_|____  z = 0, base plane
      |       |cam|       |
      |_______|___|_______| z = -base_height_mm, the rigid foot
           <- depth ->      -Y to the left

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `width_mm`       | size along X at the base                                      |
| `depth_mm`       | size along Y at the base: less than the width is flattened    |
| `length_mm`      | height at which the tip begins                                |
| `tip_mm`         | height of the tip above that                                  |
| `taper`          | width at the tip's root over width at the base                |
| `bend_mm`        | how far the centre line has moved toward +Y at `length_mm`    |
| `nail_mm`        | length of the nail below the tip's root                       |
| `nail_ratio`     | depth of the nail over the elastomer wall                     |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

The body is the bent column of `designs/column.py`, with a core smaller by the wall. The nail is a
plane parallel to the tip's axis, so its removed volume is known in closed form.

Source of the defaults: our measure of a man's thumb (width 26 mm, depth 22 mm at the joint).
Leaves out: the joint's creases, a stiff nail of its own material, screw holes in the foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.bodies import Bodies, Fields
from designs.column import Column, column_body, column_field
from designs.prisms import elliptic_foot
from designs.shells import hollow
from designs.sliders import slider
from workbench.core.base.booleans import cut, expect_volume
from workbench.core.base.errors import DesignError, GeometryError
from workbench.core.design.design import Layers

CAVITY_MM = 2.5
"""Smallest half width of the cavity: room for a camera and LEDs [mm]."""
DEEPEST_NAIL = 0.75
"""Most of the elastomer wall that the nail may take away."""
FACET_MM = 1e-4
"""Distance from the nail's plane within which a face's centre lies on it [mm]."""
NAIL_LIMIT = 1e-3
"""Tolerance of the body's volume with its nail: the kernel integrates trimmed faces to 2e-4."""


@dataclass(frozen=True, kw_only=True, slots=True)
class ThumbShape:
    """The thumb's own parameters."""

    width_mm: float = slider(
        26.0, (16.0, 40.0, 0.5), "mm", "Width", "Size along X at the base", "measured on a thumb"
    )
    depth_mm: float = slider(
        22.0, (14.0, 36.0, 0.5), "mm", "Depth", "Size along Y at the base", "measured on a thumb"
    )
    length_mm: float = slider(
        30.0, (14.0, 60.0, 0.5), "mm", "Straight length", "From base to the root of the tip"
    )
    tip_mm: float = slider(
        12.0, (8.0, 24.0, 0.5), "mm", "Tip height", "Of the rounded end above that"
    )
    taper: float = slider(
        0.9, (0.75, 1.0, 0.01), "", "Taper", "Width at the root of the tip over that at the base"
    )
    bend_mm: float = slider(
        4.0, (0.0, 10.0, 0.25), "mm", "Bend", "Shift of the centre line toward the pad"
    )
    nail_mm: float = slider(
        10.0, (4.0, 14.0, 0.5), "mm", "Nail length", "From the root of the tip down the back"
    )
    nail_ratio: float = slider(
        0.35, (0.1, 0.6, 0.05), "", "Nail depth", "Of the facet, over the elastomer wall"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        3.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def column(self) -> Column:
        """The body without its nail."""
        half_x, half_y = self.width_mm / 2, self.depth_mm / 2
        return Column(
            foot_mm=(half_x, half_y),
            head_mm=(self.taper * half_x, self.taper * half_y),
            length_mm=self.length_mm,
            tip_mm=self.tip_mm,
            bend_mm=(0.0, self.bend_mm),
        )

    def nail_depth_mm(self, z_mm: np.ndarray, layers: Layers) -> np.ndarray:
        """Depth of the nail's plane under the back at a height below the tip [mm]; may be < 0.

        The plane follows the tip's axis, the back leaves it as taper and bend: both as (1 - u)^2.
        """
        narrowing = (1.0 - self.taper) * self.depth_mm / 2
        square = (1.0 - z_mm / self.length_mm) ** 2
        return self.nail_ratio * layers.elastomer_mm + (narrowing - self.bend_mm) * square


@dataclass(frozen=True, kw_only=True, slots=True)
class Thumb:
    """Builds thumbs."""

    name: str = "thumb"
    title: str = "Thumb"
    shape_type: type = ThumbShape

    def check(self, shape: ThumbShape, layers: Layers) -> None:
        """Refuse walls that leave no room inside, and nails that cut through them.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        both_mm = layers.elastomer_mm + layers.support_mm
        room_mm = shape.column.least_mm
        if room_mm - both_mm < CAVITY_MM:
            raise DesignError(
                f"support and elastomer wall together {both_mm:g} mm leave less than "
                f"{CAVITY_MM:g} mm of cavity inside the smallest half width or tip height, "
                f"{room_mm:.3g} mm",
                hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.width_mm, "
                "shape.depth_mm, shape.taper or shape.tip_mm",
                at="layers.elastomer_mm",
            )
        low_mm = shape.length_mm - shape.nail_mm
        deepest_mm = float(shape.nail_depth_mm(np.array([low_mm]), layers)[0])
        limit_mm = DEEPEST_NAIL * layers.elastomer_mm
        if deepest_mm > limit_mm:
            raise DesignError(
                f"the nail is {deepest_mm:.3g} mm deep at its lower end, more than {limit_mm:.3g} "
                f"mm of the {layers.elastomer_mm:g} mm wall",
                hint="lower shape.nail_ratio or shape.nail_mm, or raise shape.taper",
                at="shape.nail_ratio",
            )

    def soften(self, shape: ThumbShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: ThumbShape, layers: Layers) -> tuple[float, float, float]:
        """On the pad, two thirds up the tip; lower, its rim hides the dent from the camera."""
        column = shape.column
        rise = 2.0 / 3.0
        z_mm = shape.length_mm + rise * shape.tip_mm
        centre_mm = float(column.centres(np.array([z_mm]))[0, 1])
        return 0.0, centre_mm + column.head_mm[1] * math.sqrt(1.0 - rise**2), z_mm

    def build(self, shape: ThumbShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for.
        """
        self.check(shape, layers)
        column = shape.column
        whole = column_body(column, what="outer body")
        outer = cut(whole, _nail(shape, layers), what="nail")
        expected_mm3 = column.volume_mm3 - nail_mm3(shape, layers)
        expect_volume(outer, expected_mm3, what="nail", relative=NAIL_LIMIT)
        _expect_nail(outer, shape, layers)
        core = column_body(column.inset(layers.elastomer_mm), what="core")
        both_mm = layers.elastomer_mm + layers.support_mm
        cavity = column_body(column.inset(both_mm), what="cavity")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, cavity, what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: ThumbShape, layers: Layers) -> Fields:
        """Bent columns and a plane as signed distance fields."""
        self.check(shape, layers)
        column = shape.column
        whole = column_field(column)

        def outer(points_mm: np.ndarray) -> np.ndarray:
            return np.maximum(whole(points_mm), -_nail_distance(shape, layers, points_mm))

        low, high = column.box_mm()
        return Fields(
            outer=outer,
            core=column_field(column.inset(layers.elastomer_mm)),
            cavity=column_field(column.inset(layers.elastomer_mm + layers.support_mm)),
            base=_foot(shape, layers),
            wall_mm=layers.elastomer_mm * (1.0 - shape.nail_ratio),
            low_mm=low,
            high_mm=high,
        )


def nail_mm3(shape: ThumbShape, layers: Layers) -> float:
    """What the nail removes [mm3]: a segment of each section, and of half the tip's ellipsoid.

    Segment of depth t b of an ellipse: a b (acos(1 - t) - (1 - t) sqrt(2 t - t^2)); cap of depth
    t b of an ellipsoid a, b, h, its half above the root: a b h pi t^2 (3 - t) / 6.
    """
    column = shape.column
    node, weight = np.polynomial.legendre.leggauss(200)
    z = shape.length_mm - shape.nail_mm * (1.0 - node) / 2
    axes = column.half_axes(z)
    share = np.clip(shape.nail_depth_mm(z, layers) / axes[:, 1], 0.0, 1.0)
    segment = np.arccos(1.0 - share) - (1.0 - share) * np.sqrt(2.0 * share - share**2)
    side = float(weight @ (axes.prod(axis=1) * segment)) * shape.nail_mm / 2
    half_x, half_y = column.head_mm
    depth = shape.nail_ratio * layers.elastomer_mm / half_y
    return side + half_x * half_y * column.tip_mm * math.pi * depth**2 * (3.0 - depth) / 6.0


def _plane(shape: ThumbShape, layers: Layers) -> tuple[float, float]:
    """The nail's plane y = c + s z: c [mm] and s."""
    column = shape.column
    slope = 2.0 * shape.bend_mm / shape.length_mm
    depth_mm = shape.nail_ratio * layers.elastomer_mm
    return -shape.bend_mm - column.head_mm[1] + depth_mm, slope


def _nail(shape: ThumbShape, layers: Layers) -> Any:
    """What is behind the nail's plane and above its lower end, wider than the body."""
    from build123d import Face, Solid, Vector, Wire

    offset, slope = _plane(shape, layers)
    low, high = shape.length_mm - shape.nail_mm, shape.length_mm + shape.tip_mm + 1.0
    back, side = -shape.depth_mm - 10.0, shape.width_mm / 2 + 1.0
    spots = [(offset + slope * low, low), (offset + slope * high, high), (back, high), (back, low)]
    outline = Wire.make_polygon([(-side, y, z) for y, z in spots])
    return Solid.extrude(Face(outline), Vector(2 * side, 0, 0))


def _nail_distance(shape: ThumbShape, layers: Layers, points_mm: np.ndarray) -> np.ndarray:
    offset, slope = _plane(shape, layers)
    y, z = points_mm[:, 1], points_mm[:, 2]
    behind = (y - offset - slope * z) / math.hypot(1.0, slope)
    return np.maximum(behind, shape.length_mm - shape.nail_mm - z)


def _expect_nail(outer: Any, shape: ThumbShape, layers: Layers) -> None:
    """The nail takes too little to show in the volume alone: its flat facet must be there.

    Raises:
        GeometryError: If no face of the body lies in the nail's plane.
    """
    offset, slope = _plane(shape, layers)
    for face in outer.faces():
        spot, normal = face.center(), face.normal_at()
        on_plane = abs(spot.Y - offset - slope * spot.Z) < FACET_MM
        if on_plane and abs(normal.X) < 1e-6 and abs(normal.Z + slope * normal.Y) < 1e-6:
            return
    raise GeometryError(
        "the nail is not there: no face of the body lies in its plane",
        hint="change shape.nail_ratio or shape.nail_mm a little",
        at="shape.nail_ratio",
    )


def _foot(shape: ThumbShape, layers: Layers) -> Any:
    half = shape.width_mm / 2, shape.depth_mm / 2
    cavity_mm = min(half) - layers.elastomer_mm - layers.support_mm
    return elliptic_foot(half, cavity_mm, shape.base_height_mm, shape.base_lip_mm)


FAMILY = Thumb()
