"""Trunk: the tip of an elephant's trunk, two finger-like lobes over a saddle.

It feels what lies in the saddle while the lobes close on it from both sides.

       lobe 1          lobe 0
        .--.            .--.        z = valley_mm + lobe_mm
       /    `.        .'    \\
      |       `-.__.-'       |      z = valley_mm, the saddle
      |  __________________  |      roof: layers.elastomer_mm under the saddle
      | |  ______________  | |      support (rigid, clear), flat top
      | | |              | | |
      | | |    cavity    | | |
    __|_|_|______________|_|_|__    z = 0, base plane
    |          | cam |          |
    |__________|_____|__________|   z = -base_height_mm, the rigid foot
      <------ 2 half_y ------>  +Y to the right, the section is the same along X

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `width_mm`       | size along X                                                  |
| `depth_mm`       | size along Y, across the two lobes                            |
| `valley_mm`      | height of the saddle above the base                           |
| `lobe_mm`        | height of the lobes above the saddle                          |
| `lobe_ratio`     | where the lobes are highest, over half the depth              |
| `rim_mm`         | radius of the rounded top rim                                 |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

An upright elliptic prism under the roof z(y) = valley + lobe (1 - cos(pi y / peak)) / 2, with
peak = lobe_ratio depth / 2, its rim rounded: `designs/saddle.py`. The core is an elliptic prism
with a flat top, less by the wall all around. The upper halves of the lobes are the actuators
0 (+Y) and 1 (-Y).

Source of the defaults: SimTac, trunk sensor, 34 x 26 x 50 mm overall with its housing; heights of
valley and lobes read off its figures. Leaves out: wrinkles, nostrils, screw holes in the foot.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designs.bodies import WALL_SHARE, Bodies, Fields
from designs.prisms import EllipticPrism, elliptic_foot
from designs.saddle import Saddle, saddle_body, saddle_field
from designs.sequence import Lobe, Sequence
from designs.shells import hollow
from designs.sliders import slider
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers
from workbench.core.press.indenter import BALL
from workbench.core.result.marks import Field, Marks, Region
from workbench.core.result.results import Label

CAVITY_MM = 4.0
"""Smallest half width and height of the cavity: room for camera and LEDs [mm]."""
RIM_GRID = (91, 9)
"""Places around a quarter of the core's rim, and up its rounding, where the wall is measured."""
ACTUATED_SHARE = 0.5
"""Height above the saddle from which a lobe is driven, over the lobe's height."""
CORE_RIM_SHARE = 0.3
"""Most of the core's smallest bend that its rim radius may take."""
CLOSE_DEG = 20.0
"""How far the lobes close [degree]: 2 mm at the top of a lobe of 6 mm. Measured, least J: at 20
degrees 0.76, 0.61 and 0.37 on grids of 1, 0.8 and 0.6 mm; on 1 mm 0.46 at 30 and 0.13 at 45."""
HELD_SHARE = 1.1
"""Diameter of the held ball over the distance of the lobes' tops from the middle."""
HELD_DEPTH_SHARE = 0.2
"""How deep it is pressed into the saddle, over the wall."""
GRID_SHARE = 0.32
"""Grid of the contact solver over the wall."""
SIMTAC = "SimTac, trunk sensor"


@dataclass(frozen=True, kw_only=True, slots=True)
class TrunkShape:
    """The trunk's own parameters."""

    width_mm: float = slider(
        34.0, (24.0, 50.0, 0.5), "mm", "Width", "Size along X, along the saddle", SIMTAC
    )
    depth_mm: float = slider(
        26.0, (20.0, 40.0, 0.5), "mm", "Depth", "Size along Y, from lobe to lobe", SIMTAC
    )
    valley_mm: float = slider(
        30.0, (14.0, 50.0, 0.5), "mm", "Saddle height", "From the base to the saddle", SIMTAC
    )
    lobe_mm: float = slider(
        6.0, (2.0, 12.0, 0.25), "mm", "Lobe height", "How far the lobes stand above the saddle"
    )
    lobe_ratio: float = slider(
        0.7, (0.6, 0.9, 0.05), "", "Lobe place", "Where lobes are highest, over half the depth"
    )
    rim_mm: float = slider(
        2.0, (0.5, 3.0, 0.1), "mm", "Rim radius", "Rounding of the top rim and of the core's"
    )
    base_height_mm: float = slider(
        14.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        0.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def peak_mm(self) -> float:
        """Distance of the lobes' highest points from the plane between them [mm]."""
        return self.lobe_ratio * self.depth_mm / 2

    @property
    def saddle(self) -> Saddle:
        """The body with its two lobes."""
        return Saddle(
            half_mm=self.half_mm(0.0),
            valley_mm=self.valley_mm,
            lobe_mm=self.lobe_mm,
            peak_mm=self.peak_mm,
            rim_mm=self.rim_mm,
        )

    def half_mm(self, inset_mm: float) -> tuple[float, float]:
        """Half axes of the ellipse less by an inset [mm]."""
        return self.width_mm / 2 - inset_mm, self.depth_mm / 2 - inset_mm

    def core(self, inset_mm: float) -> EllipticPrism:
        """What is inside a wall; its rim is the trunk's, as far as its narrow ends allow."""
        half_x, half_y = self.half_mm(inset_mm)
        bend_mm = min(half_x, half_y) ** 2 / max(half_x, half_y)
        return EllipticPrism(
            half_mm=(half_x, half_y),
            top_mm=self.valley_mm - inset_mm,
            rim_mm=min(self.rim_mm, CORE_RIM_SHARE * bend_mm),
        )


@dataclass(frozen=True, kw_only=True, slots=True)
class Trunk:
    """Builds trunks."""

    name: str = "trunk"
    title: str = "Elephant trunk"
    shape_type: type = TrunkShape

    def check(self, shape: TrunkShape, layers: Layers) -> None:
        """Refuse walls that leave no room inside, and rims that eat the wall.

        Raises:
            DesignError: If skin and support leave less than 4 mm of cavity in any half width or
                in height, or if the rounded rim leaves less than half of the skin.
        """
        both_mm = layers.elastomer_mm + layers.support_mm
        for what, room_mm in (
            ("half depth", shape.depth_mm / 2),
            ("half width", shape.width_mm / 2),
            ("saddle height", shape.valley_mm),
        ):
            if room_mm - both_mm < CAVITY_MM:
                raise DesignError(
                    f"support and elastomer wall together {both_mm:g} mm leave less than "
                    f"{CAVITY_MM:g} mm of cavity inside the {what} {room_mm:g} mm",
                    hint="lower layers.elastomer_mm or layers.support_mm, or raise "
                    "shape.width_mm, shape.depth_mm or shape.valley_mm",
                    at="layers.elastomer_mm",
                )
        wall_mm, limit_mm = least_wall_mm(shape, layers), WALL_SHARE * layers.elastomer_mm
        if wall_mm < limit_mm:
            raise DesignError(
                f"the rim of radius {shape.rim_mm:g} mm leaves {max(wall_mm, 0.0):.2f} mm of the "
                f"elastomer wall of {layers.elastomer_mm:g} mm, less than {limit_mm:g} mm",
                hint="lower shape.rim_mm or shape.lobe_mm, or raise shape.lobe_ratio or "
                "layers.elastomer_mm",
                at="shape.rim_mm",
            )

    def soften(self, shape: TrunkShape) -> TrunkShape:
        """The trunk with half the rim radius."""
        return replace(shape, rim_mm=shape.rim_mm / 2)

    def target(self, shape: TrunkShape, layers: Layers) -> tuple[float, float, float]:
        """The middle of the saddle."""
        return 0.0, 0.0, shape.valley_mm

    def sequences(self, shape: TrunkShape, layers: Layers) -> dict[str, Sequence]:
        """The grip of SimTac's Fig. 10: a ball is sensed in the saddle, then held by both lobes.

        Each lobe turns about a line along X under its top, at the height of the saddle.
        """
        lobes = tuple(
            Lobe(
                region=f"actuator_{number}",
                root_mm=(0.0, sign * shape.peak_mm, shape.valley_mm),
                # Right-handed about +X the top at +Y goes toward -Y.
                axis=(sign, 0.0, 0.0),
                outward=(0.0, sign, 0.0),
            )
            for number, sign in enumerate((1.0, -1.0))
        )
        grip = Sequence(
            title="Press a ball on the saddle and close both lobes on it",
            kind=BALL,
            lobes=lobes,
            close_deg=CLOSE_DEG,
            size_mm=round(HELD_SHARE * shape.peak_mm, 1),
            depth_mm=round(HELD_DEPTH_SHARE * layers.elastomer_mm, 2),
            grid_mm=round(GRID_SHARE * layers.elastomer_mm, 2),
        )
        return {"grip": grip}

    def build(self, shape: TrunkShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for.
        """
        self.check(shape, layers)
        both_mm = layers.elastomer_mm + layers.support_mm
        outer = saddle_body(shape.saddle)
        core = shape.core(layers.elastomer_mm).body(what="core")
        cavity = shape.core(both_mm).body(what="cavity")
        return Bodies(
            membrane=hollow(outer, core, what="elastomer"),
            outer=outer,
            core=core,
            support=hollow(core, cavity, what="support"),
            base=_foot(shape, layers),
            marks=_marks(shape),
        )

    def fields(self, shape: TrunkShape, layers: Layers) -> Fields:
        """Elliptic prisms under the roof as signed distance fields."""
        self.check(shape, layers)
        half_x, half_y = shape.half_mm(0.0)
        return Fields(
            outer=saddle_field(shape.saddle),
            core=shape.core(layers.elastomer_mm).distance,
            cavity=shape.core(layers.elastomer_mm + layers.support_mm).distance,
            base=_foot(shape, layers),
            wall_mm=layers.elastomer_mm,
            low_mm=(-half_x, -half_y, 0.0),
            high_mm=(half_x, half_y, shape.valley_mm + shape.lobe_mm),
            marks=_marks(shape),
        )


def least_wall_mm(shape: TrunkShape, layers: Layers) -> float:
    """Thinnest skin over the rounded rim of the core [mm], by the outer field.

    Over a square edge with radii R outside and r inside, the wall t is still
    sqrt(2) t - (sqrt(2) - 1) (R - r) thick. Where the lobes' ridge, of radius
    2 peak^2 / (pi^2 lobe), is sharper than the rim, the edge is not square and more is lost.
    """
    core = shape.core(layers.elastomer_mm)
    half, rim_mm = core.half_mm, core.rim_mm
    around, up = (np.linspace(0.0, np.pi / 2, count) for count in RIM_GRID)
    edge = np.column_stack([half[0] * np.cos(around), half[1] * np.sin(around)])
    normal = edge / np.square(half)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    plan = edge[:, None] - rim_mm * (1.0 - np.cos(up))[None, :, None] * normal[:, None]
    height = core.top_mm - rim_mm * (1.0 - np.sin(up))
    places = np.concatenate([plan, np.broadcast_to(height[:, None], (*plan.shape[:2], 1))], axis=2)
    return float(-saddle_field(shape.saddle)(places.reshape(-1, 3)).max())


def _foot(shape: TrunkShape, layers: Layers) -> Any:
    half = shape.half_mm(0.0)
    cavity_mm = min(half) - layers.elastomer_mm - layers.support_mm
    return elliptic_foot(half, cavity_mm, shape.base_height_mm, shape.base_lip_mm)


def _marks(shape: TrunkShape) -> Marks:
    """The upper part of each lobe is driven: actuator 0 at +Y, 1 at -Y."""
    level_mm = shape.valley_mm + ACTUATED_SHARE * shape.lobe_mm

    def lobe(sign: float) -> Field:
        return lambda points_mm: np.minimum(points_mm[:, 2] - level_mm, sign * points_mm[:, 1])

    return Marks(
        regions=tuple(
            Region(
                label=Label.ACTUATOR,
                number=number,
                within=Label.OUTER,
                inside=lobe(sign),
                imprint=True,
            )
            for number, sign in enumerate((1.0, -1.0))
        )
    )


FAMILY = Trunk()
