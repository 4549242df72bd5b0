"""Tentacle: a piece of an octopus's bent arm with rows of suckers on the outside of the bend.

An octopus feels through its suckers: short, thick stubs with a flat or cupped end.

                    /\\ sucker
              _.---/  \\--.         the arm bends toward +Y; suckers stand away from the bend's axis
         [ ].'             `-.
          .'  .-----------.   \\    outside in: elastomer, support (rigid, clear), cavity
      [  /  .'     .---.   \\   \\
      [_|  |     .'     `.  \\   |  the end is flat, across the arm
        |  |    |         `--'--'
     ___|__|____|________________  z = 0, base plane: the other end, level
    |     | cam |     |            +Y to the right, seen along X
    |_____|_____|_____|            z = -base_height_mm, the rigid foot

| parameter          | meaning                                                     |
|--------------------|-------------------------------------------------------------|
| `width_mm`         | size of the arm's section along X                           |
| `depth_mm`         | size of the section in the plane of the bend                |
| `bend_radius_mm`   | from the bend's axis to the middle of the arm               |
| `turn_deg`         | angle through which the arm bends, from foot to end         |
| `rows`             | rows of suckers, one or two                                 |
| `row_mm`           | distance of two rows                                        |
| `sucker_count`     | suckers in a row                                            |
| `pitch_deg`        | angle between neighbours about the bend's axis              |
| `sucker_radius_mm` | radius of a sucker                                          |
| `sucker_mm`        | how far suckers stand out of the arm's ridge                |
| `cup_ratio`        | radius of the cup over that of the sucker                   |
| `cup_depth`        | depth of the cup over how far the sucker stands out; 0 flat |
| `base_height_mm`   | height of the foot                                          |
| `base_lip_mm`      | how far the foot stands out beyond the skin                 |

The arm is that of `designs/arm.py`, with a core smaller by the wall, which slides out along its own
arc. A sucker (`designs/suckers.py`) is a cylinder toward the bend's axis, bored by its cup.

Source of the defaults: the released SimTac mesh of the tentacle (MIT), 36 x 26 mm bent by 80
degrees at a radius of 40 mm, two rows of three flat suckers. Leaves out: taper, a rounded tip, the
muscle ring inside a sucker, screw holes in the foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.arm import Arm, arm_body, arm_field
from designs.bodies import WALL_SHARE, Bodies, Fields
from designs.prisms import elliptic_foot
from designs.shells import hollow
from designs.sliders import slider
from designs.suckers import (
    Row,
    Sucker,
    check_suckers,
    expect_suckers,
    sucker_body,
    sucker_distance,
    sucker_mm3,
    suckers_along,
)
from workbench.core.base.booleans import expect_volume, fuse
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers

CAVITY_MM = 4.0
"""Smallest half width of the cavity: room for a small camera and LEDs [mm]."""
HOLLOW_MM = 4.0
"""Smallest radius of the bend's inner side [mm]."""
VOLUME_ERROR = 1e-4
"""The kernel integrates the trimmed side to some 1e-5."""
SIMTAC = "measured on the released SimTac mesh of the tentacle"


@dataclass(frozen=True, kw_only=True, slots=True)
class TentacleShape:
    """The tentacle's own parameters."""

    width_mm: float = slider(
        36.0, (20.0, 60.0, 0.5), "mm", "Width", "Size of the arm along X", SIMTAC
    )
    depth_mm: float = slider(
        26.0, (18.0, 48.0, 0.5), "mm", "Depth", "Size of the arm in the plane of the bend", SIMTAC
    )
    bend_radius_mm: float = slider(
        40.0, (20.0, 200.0, 1.0), "mm", "Bend radius", "From the bend's axis to the arm", SIMTAC
    )
    turn_deg: float = slider(
        80.0, (10.0, 90.0, 1.0), "degree", "Bend", "Angle from the foot to the end", SIMTAC
    )
    rows: float = slider(2.0, (1.0, 2.0, 1.0), "", "Rows", "Rows of suckers", SIMTAC)
    row_mm: float = slider(
        18.0, (4.0, 36.0, 0.5), "mm", "Row distance", "Between the axes of two rows", SIMTAC
    )
    sucker_count: float = slider(3.0, (1.0, 6.0, 1.0), "", "Suckers", "Suckers in a row", SIMTAC)
    pitch_deg: float = slider(
        23.0, (3.0, 45.0, 0.5), "degree", "Pitch", "Angle between suckers of a row", SIMTAC
    )
    sucker_radius_mm: float = slider(
        8.0, (1.5, 10.0, 0.25), "mm", "Sucker radius", "Radius of a sucker", SIMTAC
    )
    sucker_mm: float = slider(
        5.0, (1.0, 8.0, 0.25), "mm", "Sucker height", "How far they stand out of the ridge", SIMTAC
    )
    cup_ratio: float = slider(
        0.65, (0.4, 0.8, 0.05), "", "Cup size", "Radius of the cup over that of the sucker"
    )
    cup_depth: float = slider(
        0.0, (0.0, 0.8, 0.05), "", "Cup depth", "Over how far the sucker stands out; 0 is flat"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        3.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def arm(self) -> Arm:
        """The arm without its suckers."""
        return Arm(
            half_mm=(self.width_mm / 2, self.depth_mm / 2),
            bend_radius_mm=self.bend_radius_mm,
            turn=math.radians(self.turn_deg),
        )

    @property
    def places_mm(self) -> tuple[float, ...]:
        """X of each row [mm]."""
        return (0.0,) if self.rows == 1 else (self.row_mm / 2, -self.row_mm / 2)

    @property
    def suckers(self) -> list[Sucker]:
        """All suckers from the base up."""
        row = Row(
            count=round(self.sucker_count),
            pitch=math.radians(self.pitch_deg),
            radius_mm=self.sucker_radius_mm,
            out_mm=self.sucker_mm,
            cup_ratio=self.cup_ratio,
            cup_depth=self.cup_depth,
        )
        return suckers_along(self.arm, row, self.places_mm)


@dataclass(frozen=True, kw_only=True, slots=True)
class Tentacle:
    """Builds tentacles."""

    name: str = "tentacle"
    title: str = "Octopus tentacle"
    eye: tuple[float, float, float] = (1.6, -1.8, 0.9)
    """Suckers stand at -Y."""
    shape_type: type = TentacleShape

    def check(self, shape: TentacleShape, layers: Layers) -> None:
        """Refuse walls without room, bends that are too tight, and suckers that touch.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        _check_walls(shape, layers)
        for name in ("rows", "sucker_count"):
            count = getattr(shape, name)
            if count != round(count):
                raise DesignError(
                    f"{name.replace('_', ' ')} {count:g} is not a whole number",
                    hint=f"choose {round(count)}",
                    at=f"shape.{name}",
                )
        check_suckers(shape.arm, shape.suckers)

    def soften(self, shape: TentacleShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: TentacleShape, layers: Layers) -> tuple[float, float, float]:
        """The skin amid the four lowest suckers, or the end of the lowest one of a single row.

        On a sucker the whole end gives way, so that its image changes little over a wide place.
        """
        first, arm = shape.suckers[0], shape.arm
        place = first.place_mm(first.out_mm - first.cup_mm)
        if shape.rows > 1 and shape.sucker_count > 1:
            middle = arm.turn / 2 - math.radians(shape.pitch_deg) * (shape.sucker_count / 2 - 1)
            place = arm.place_mm(middle, arm.half_mm[1])
        x, y, z = place.tolist()
        return x, y, z

    def build(self, shape: TentacleShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for, or a sucker
                or its cup is missing.
        """
        self.check(shape, layers)
        arm, suckers = shape.arm, shape.suckers
        outer = arm_body(arm, what="arm")
        for number, sucker in enumerate(suckers):
            outer = fuse(outer, sucker_body(sucker), what=f"sucker {number + 1}")
        expect_suckers(outer, suckers)
        whole_mm3 = arm.volume_mm3 + sum(sucker_mm3(arm, sucker) for sucker in suckers)
        expect_volume(outer, whole_mm3, what="arm and suckers", relative=VOLUME_ERROR)
        core = arm_body(arm.inset(layers.elastomer_mm), what="core")
        cavity = arm_body(arm.inset(layers.elastomer_mm + layers.support_mm), what="cavity")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, cavity, what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: TentacleShape, layers: Layers) -> Fields:
        """A bent arm and bored cylinders as signed distance fields."""
        self.check(shape, layers)
        arm, suckers = shape.arm, shape.suckers
        bare = arm_field(arm)

        def outer(points_mm: np.ndarray) -> np.ndarray:
            whole = bare(points_mm)
            for sucker in suckers:
                whole = np.minimum(whole, sucker_distance(sucker, points_mm))
            return whole

        low, high = arm.box_mm()
        for sucker in suckers:
            rim = sucker.place_mm(sucker.out_mm)
            reach = sucker.radius_mm * np.sqrt(1.0 - sucker.axis**2)
            low, high = np.minimum(low, rim - reach), np.maximum(high, rim + reach)
        return Fields(
            outer=outer,
            core=arm_field(arm.inset(layers.elastomer_mm)),
            cavity=arm_field(arm.inset(layers.elastomer_mm + layers.support_mm)),
            base=_foot(shape, layers),
            wall_mm=layers.elastomer_mm,
            low_mm=tuple(low.tolist()),
            high_mm=tuple(high.tolist()),
        )


def _check_walls(shape: TentacleShape, layers: Layers) -> None:
    """Refuse arms that bend about themselves, and walls that leave no room in them."""
    both_mm = layers.elastomer_mm + layers.support_mm
    inner_mm = shape.bend_radius_mm - shape.depth_mm / 2
    if inner_mm < HOLLOW_MM:
        raise DesignError(
            f"the inner side of the bend has a radius of {inner_mm:g} mm, less than "
            f"{HOLLOW_MM:g} mm",
            hint="raise shape.bend_radius_mm or lower shape.depth_mm",
            at="shape.bend_radius_mm",
        )
    for name in ("width", "depth"):
        half_mm = getattr(shape, f"{name}_mm") / 2
        if half_mm - both_mm < CAVITY_MM:
            raise DesignError(
                f"support and elastomer wall together {both_mm:g} mm leave less than "
                f"{CAVITY_MM:g} mm of cavity inside the half {name} {half_mm:g} mm",
                hint=f"lower layers.elastomer_mm or layers.support_mm, or raise shape.{name}_mm",
                at="layers.elastomer_mm",
            )
    least_mm = shape.arm.least_wall_mm(layers.elastomer_mm)
    if least_mm < WALL_SHARE * layers.elastomer_mm:
        raise DesignError(
            f"so flat a section thins the elastomer wall to {least_mm:.2f} mm, less than "
            f"{WALL_SHARE:.0%} of {layers.elastomer_mm:g} mm",
            hint="bring shape.width_mm and shape.depth_mm nearer each other",
            at="shape.depth_mm",
        )
    cavity_mm = shape.arm.inset(both_mm).turn * (inner_mm + both_mm)
    if cavity_mm < 2 * CAVITY_MM:
        raise DesignError(
            f"the inner side of the cavity is {cavity_mm:.3g} mm long, less than "
            f"{2 * CAVITY_MM:g} mm",
            hint="raise shape.turn_deg or shape.bend_radius_mm, or lower the layers",
            at="shape.turn_deg",
        )


def _foot(shape: TentacleShape, layers: Layers) -> Any:
    half = shape.arm.half_mm
    cavity_mm = min(half) - layers.elastomer_mm - layers.support_mm
    return elliptic_foot(half, cavity_mm, shape.base_height_mm, shape.base_lip_mm)


FAMILY = Tentacle()
