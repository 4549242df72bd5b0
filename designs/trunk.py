"""Trunk: the tip of an elephant's trunk, one saddle between two protrusions that close on it.

It feels what lies in the saddle while the protrusions close on it from both sides.

      .-.                    .-.        z = valley_mm + lobe_mm
     |   \\                  /   |
     |    `._            _.'    |
     |       `--.____.--'       |      z = valley_mm, the saddle
     |  ______________________  |      roof: layers.elastomer_mm under the saddle
     | |  __________________  | |      support (rigid, clear), flat top
     | | |                  | | |
     | | |      cavity      | | |
    _|_|_|__________________|_|_|_     z = 0, base plane
    |            | cam |          |
    |____________|_____|__________|    z = -base_height_mm, the rigid foot
      <------- 2 half_y ------->  +Y to the right; along X the saddle is level

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `width_mm`       | size along X, along the saddle                                |
| `depth_mm`       | size along Y, across the protrusions                          |
| `valley_mm`      | height of the saddle above the base                           |
| `lobe_mm`        | height of the protrusions above the saddle                    |
| `rim_mm`         | radius of the rounded top rim: that of the protrusions' tops  |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the skin                   |

An upright elliptic prism whose top is a round trough along X, its rim rounded: `designs/saddle.py`.
The core is an elliptic prism with a flat top, less by the wall all around. A large rim makes two
thick, finger-like lobes. The upper part of each protrusion has two active surfaces, four together:
its top with the rim (actuators 0 at +Y, 1 at -Y) and its back below (2 and 3).

Source of the defaults: the released SimTac mesh of the trunk (MIT), 35 x 30 x 35 mm, whose nodes
name four active surfaces: rim and back of each protrusion; 50 mm high with its housing as the
paper says. Leaves out: wrinkles, nostrils, screw holes in the foot.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from designs.bodies import WALL_SHARE, Bodies, Fields
from designs.prisms import EllipticPrism, elliptic_foot
from designs.saddle import (
    SIDES,
    Saddle,
    check_saddle,
    driven_surfaces,
    saddle_body,
    saddle_field,
)
from designs.sequence import Lobe, Sequence
from designs.shells import hollow
from designs.sliders import slider
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers
from workbench.core.press.indenter import BALL
from workbench.core.result.marks import Marks

CAVITY_MM = 4.0
"""Smallest half width and height of the cavity: room for camera and LEDs [mm]."""
RIM_GRID = (91, 9)
"""Places around a quarter of the core's rim, and up its rounding, where the wall is measured."""
ACTUATED_SHARE = 0.67
"""Half width of the active backs over that of the body; as on the released mesh."""
SOFTER = 0.75
"""Rim that is tried after one that could not be rounded: half of it changes the volume by 3 %."""
CORE_RIM_SHARE = 0.3
"""Most of the core's smallest bend that its rim radius may take."""
CLOSE_DEG = 14.0
"""How far the lobes close [degree]: 2.1 mm at the top of a lobe of 6.25 mm over a wall of 2.5 mm.
Measured with the ball of the grip on its grid of 0.8 mm: least J 0.73."""
HELD_SHARE = 1.5
"""Diameter of the held ball over the distance of the crests from the middle."""
HELD_DEPTH_SHARE = 0.2
"""How deep it is pressed into the saddle, over the wall."""
GRID_SHARE = 0.32
"""Grid of the contact solver over the wall."""
SIMTAC = "measured on the released SimTac mesh of the trunk"


@dataclass(frozen=True, kw_only=True, slots=True)
class TrunkShape:
    """The trunk's own parameters."""

    width_mm: float = slider(
        35.0, (24.0, 50.0, 0.5), "mm", "Width", "Size along X, along the saddle", SIMTAC
    )
    depth_mm: float = slider(
        30.0, (20.0, 40.0, 0.5), "mm", "Depth", "Size along Y, across the protrusions", SIMTAC
    )
    valley_mm: float = slider(
        28.75, (14.0, 50.0, 0.25), "mm", "Saddle height", "From the base to the saddle", SIMTAC
    )
    lobe_mm: float = slider(
        6.25,
        (2.0, 9.0, 0.25),
        "mm",
        "Lobe height",
        "How far both ends rise above the saddle",
        SIMTAC,
    )
    rim_mm: float = slider(
        1.875,
        (0.5, 4.0, 0.125),
        "mm",
        "Rim radius",
        "Rounding of the top rim, and of the core's",
        SIMTAC,
    )
    base_height_mm: float = slider(
        15.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        0.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def saddle(self) -> Saddle:
        """The body with its two protrusions."""
        return Saddle(
            half_mm=self.half_mm(0.0),
            valley_mm=self.valley_mm,
            lobe_mm=self.lobe_mm,
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
        """Refuse walls that leave no room inside, rims that eat the wall, and lobes too steep.

        Raises:
            DesignError: If skin and support leave less than 4 mm of cavity in any half width or
                in height, if the rim bends sharper than the outline allows or leaves less than
                half of the skin, or if the saddle is steeper than its rim can be rounded.
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
        check_saddle(shape.saddle)
        wall_mm, limit_mm = least_wall_mm(shape, layers), WALL_SHARE * layers.elastomer_mm
        if wall_mm < limit_mm:
            raise DesignError(
                f"the rim of radius {shape.rim_mm:g} mm leaves {max(wall_mm, 0.0):.2f} mm of the "
                f"elastomer wall of {layers.elastomer_mm:g} mm, less than {limit_mm:g} mm",
                hint="lower shape.rim_mm or raise layers.elastomer_mm",
                at="shape.rim_mm",
            )

    def soften(self, shape: TrunkShape) -> TrunkShape:
        """The trunk with three quarters of the rim radius, whose saddle is flatter as well."""
        return replace(shape, rim_mm=SOFTER * shape.rim_mm)

    def target(self, shape: TrunkShape, layers: Layers) -> tuple[float, float, float]:
        """The middle of the saddle."""
        return 0.0, 0.0, shape.valley_mm

    def sequences(self, shape: TrunkShape, layers: Layers) -> dict[str, Sequence]:
        """The grip of SimTac's Fig. 10: a ball is sensed in the saddle, then held from both sides.

        Top and back of a protrusion turn together about a line along X under its crest, where it
        leaves the core.
        """
        peak_mm = shape.saddle.peak_mm
        lobes = tuple(
            Lobe(
                region=f"actuator_{number}",
                root_mm=(0.0, sign * peak_mm, _root_mm(shape, layers)),
                # Right-handed about +X the top at +Y goes toward -Y.
                axis=(sign, 0.0, 0.0),
                outward=(0.0, sign, 0.0),
            )
            for number, sign in enumerate(2 * SIDES)
        )
        grip = Sequence(
            title="Press a ball on the saddle and close both lobes on it",
            kind=BALL,
            lobes=lobes,
            close_deg=CLOSE_DEG,
            size_mm=round(HELD_SHARE * peak_mm, 1),
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
            marks=_marks(shape, layers),
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
            marks=_marks(shape, layers),
        )


def least_wall_mm(shape: TrunkShape, layers: Layers) -> float:
    """Thinnest skin over the rounded rim of the core [mm], by the outer field.

    Over a square edge with radii R outside and r inside, the wall t is still
    sqrt(2) t - (sqrt(2) - 1) (R - r) thick.
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


def _marks(shape: TrunkShape, layers: Layers) -> Marks:
    regions = driven_surfaces(
        shape.saddle,
        reach_mm=ACTUATED_SHARE * shape.width_mm / 2,
        root_mm=_root_mm(shape, layers),
    )
    return Marks(regions=regions)


def _root_mm(shape: TrunkShape, layers: Layers) -> float:
    """Height at which a protrusion leaves the core, and about which it turns [mm]."""
    return shape.valley_mm - layers.elastomer_mm


FAMILY = Trunk()
