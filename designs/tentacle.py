"""Tentacle: a tapered, bent arm with tubular suckers along one side.

An octopus feels through its suckers: each is a short tube with an open cup at its end.

              .-.             z = length_mm + tip_mm
             /   \\
            |     |=]         suckers on the +Y side, smaller toward the tip
           |  .-.  |
           | |   | |==]
          |  |   |  |         outside in: elastomer, support (rigid, clear), cavity
          |  |   |  |===]
         |  |     |  |
     ____|__|_____|__|____    z = 0, base plane
    |       | cam |       |
    |_______|_____|_______|   z = -base_height_mm, the rigid foot

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `base_radius_mm` | radius of the arm at the base                                 |
| `tip_radius_mm`  | radius of the arm at the root of its rounded tip              |
| `length_mm`      | height at which the tip begins                                |
| `bend_mm`        | shift of the centre line toward +Y at `length_mm`             |
| `sucker_count`   | number of suckers, evenly spaced                              |
| `sucker_ratio`   | radius of a sucker over the arm's radius at its place         |
| `sucker_mm`      | how far the suckers stand out                                 |
| `cup_ratio`      | radius of the cup over that of the sucker                     |
| `cup_depth`      | depth of the cup over how far the sucker stands out           |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

The arm is the bent column of `designs/column.py`, with a core smaller by the wall. A sucker
(`designs/suckers.py`) is a cylinder along the normal of the arm's side, bored by its cup.

Source of the defaults: our choice, an arm of the size of the finger. Leaves out: two rows of
suckers, the muscle ring inside a sucker, screw holes in the foot.
"""

from __future__ import annotations

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.bodies import WALL_SHARE, Bodies, Fields
from designs.column import Column, column_body, column_field
from designs.prisms import elliptic_foot
from designs.shells import hollow
from designs.sliders import slider
from designs.suckers import Sucker, expect_suckers, sucker_body, sucker_distance, suckers_along
from workbench.core.base.booleans import fuse
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers

CAVITY_MM = 2.0
"""Smallest half width of the cavity: room for a small camera [mm]."""
BETWEEN_MM = 0.5
"""Smallest gap between suckers, and from a sucker to the base [mm]."""
LEAST_WALL_MM = 0.4
"""Thinnest wall of a sucker beside its cup [mm]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TentacleShape:
    """The tentacle's own parameters."""

    base_radius_mm: float = slider(
        14.0, (9.0, 24.0, 0.5), "mm", "Base radius", "Radius of the arm at the base"
    )
    tip_radius_mm: float = slider(
        8.0, (5.0, 16.0, 0.5), "mm", "Tip radius", "Radius of the arm where its tip begins"
    )
    length_mm: float = slider(
        40.0, (20.0, 80.0, 0.5), "mm", "Arm length", "From base to the root of the tip"
    )
    bend_mm: float = slider(
        6.0, (0.0, 12.0, 0.5), "mm", "Bend", "Shift of the centre line toward the suckers"
    )
    sucker_count: float = slider(3.0, (1.0, 6.0, 1.0), "", "Suckers", "Suckers along the arm")
    sucker_ratio: float = slider(
        0.38, (0.2, 0.5, 0.01), "", "Sucker size", "Radius of a sucker over the arm's there"
    )
    sucker_mm: float = slider(
        3.0, (1.0, 6.0, 0.25), "mm", "Sucker height", "How far the suckers stand out"
    )
    cup_ratio: float = slider(
        0.65, (0.4, 0.8, 0.05), "", "Cup size", "Radius of the cup over that of the sucker"
    )
    cup_depth: float = slider(
        0.6, (0.2, 0.8, 0.05), "", "Cup depth", "Over how far the sucker stands out"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        3.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def column(self) -> Column:
        """The arm without its suckers; its tip is half a sphere, sheared by the bend."""
        base, tip = self.base_radius_mm, self.tip_radius_mm
        return Column(
            foot_mm=(base, base),
            head_mm=(tip, tip),
            length_mm=self.length_mm,
            tip_mm=tip,
            bend_mm=(0.0, self.bend_mm),
        )

    @property
    def suckers(self) -> list[Sucker]:
        """All suckers from the base up."""
        return suckers_along(
            self.column,
            round(self.sucker_count),
            ratio=self.sucker_ratio,
            out_mm=self.sucker_mm,
            cup_ratio=self.cup_ratio,
            cup_depth=self.cup_depth,
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Tentacle:
    """Builds tentacles."""

    name: str = "tentacle"
    title: str = "Octopus tentacle"
    shape_type: type = TentacleShape

    def check(self, shape: TentacleShape, layers: Layers) -> None:
        """Refuse arms that widen or narrow too fast, walls without room, and suckers that touch.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        if shape.tip_radius_mm > shape.base_radius_mm:
            raise DesignError(
                f"tip radius {shape.tip_radius_mm:g} mm is more than the base radius "
                f"{shape.base_radius_mm:g} mm",
                hint="lower shape.tip_radius_mm or raise shape.base_radius_mm",
                at="shape.tip_radius_mm",
            )
        both_mm = layers.elastomer_mm + layers.support_mm
        if shape.tip_radius_mm - both_mm < CAVITY_MM:
            raise DesignError(
                f"support and elastomer wall together {both_mm:g} mm leave less than "
                f"{CAVITY_MM:g} mm of cavity inside the tip radius {shape.tip_radius_mm:g} mm",
                hint="lower layers.elastomer_mm or layers.support_mm, or raise shape.tip_radius_mm",
                at="layers.elastomer_mm",
            )
        _check_slope(shape, layers)
        _check_suckers(shape)

    def soften(self, shape: TentacleShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: TentacleShape, layers: Layers) -> tuple[float, float, float]:
        """The end of the arm: dents of the suckers lie where the camera does not see them."""
        return shape.column.apex_mm

    def build(self, shape: TentacleShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for, or a sucker
                or its cup is missing.
        """
        self.check(shape, layers)
        outer = column_body(shape.column, what="arm")
        for number, sucker in enumerate(shape.suckers):
            outer = fuse(outer, sucker_body(sucker), what=f"sucker {number + 1}")
        expect_suckers(outer, shape.suckers)
        core = column_body(shape.column.inset(layers.elastomer_mm), what="core")
        both_mm = layers.elastomer_mm + layers.support_mm
        cavity = column_body(shape.column.inset(both_mm), what="cavity")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, cavity, what="support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: TentacleShape, layers: Layers) -> Fields:
        """A bent column and bored cylinders as signed distance fields."""
        self.check(shape, layers)
        column = shape.column
        arm, suckers = column_field(column), shape.suckers

        def outer(points_mm: np.ndarray) -> np.ndarray:
            whole = arm(points_mm)
            for sucker in suckers:
                whole = np.minimum(whole, sucker_distance(sucker, points_mm))
            return whole

        low, high = (np.array(corner) for corner in column.box_mm())
        for sucker in suckers:
            rim = sucker.place_mm(sucker.out_mm)
            reach = sucker.radius_mm * np.sqrt(1.0 - sucker.axis**2)
            low, high = np.minimum(low, rim - reach), np.maximum(high, rim + reach)
        return Fields(
            outer=outer,
            core=column_field(column.inset(layers.elastomer_mm)),
            cavity=column_field(column.inset(layers.elastomer_mm + layers.support_mm)),
            base=_foot(shape, layers),
            wall_mm=layers.elastomer_mm,
            low_mm=tuple(low.tolist()),
            high_mm=tuple(high.tolist()),
        )


def _check_slope(shape: TentacleShape, layers: Layers) -> None:
    """Refuse tapers and bends so steep that the wall, even level by level, gets thin."""
    share = shape.column.wall_share
    if share < WALL_SHARE:
        raise DesignError(
            f"taper and bend over {shape.length_mm:g} mm thin the elastomer wall to "
            f"{share * layers.elastomer_mm:.2f} mm, less than {WALL_SHARE:.0%} of "
            f"{layers.elastomer_mm:g} mm",
            hint="raise shape.length_mm or shape.tip_radius_mm, or lower shape.base_radius_mm",
            at="shape.length_mm",
        )


def _check_suckers(shape: TentacleShape) -> None:
    """Refuse suckers that touch each other or the base, or whose wall is too thin."""
    if shape.sucker_count != round(shape.sucker_count):
        raise DesignError(
            f"sucker count {shape.sucker_count:g} is not a whole number",
            hint=f"choose {round(shape.sucker_count)}",
            at="shape.sucker_count",
        )
    suckers = shape.suckers
    thinnest_mm = min(sucker.radius_mm for sucker in suckers) * (1.0 - shape.cup_ratio)
    if thinnest_mm < LEAST_WALL_MM:
        raise DesignError(
            f"the smallest sucker's wall is {thinnest_mm:.2g} mm beside its cup, less than "
            f"{LEAST_WALL_MM:g} mm",
            hint="lower shape.cup_ratio or raise shape.sucker_ratio",
            at="shape.cup_ratio",
        )
    gaps = [suckers[0].lowest_mm]
    gaps += [one.gap_mm(two) for one, two in itertools.pairwise(suckers)]
    if min(gaps) < BETWEEN_MM:
        raise DesignError(
            f"the suckers stand {min(gaps):.2g} mm apart or from the base, less than "
            f"{BETWEEN_MM:g} mm",
            hint="lower shape.sucker_count or shape.sucker_ratio, or raise shape.length_mm",
            at="shape.sucker_count",
        )


def _foot(shape: TentacleShape, layers: Layers) -> Any:
    radius_mm = shape.base_radius_mm
    cavity_mm = radius_mm - layers.elastomer_mm - layers.support_mm
    half = radius_mm, radius_mm
    return elliptic_foot(half, cavity_mm, shape.base_height_mm, shape.base_lip_mm)


FAMILY = Tentacle()
