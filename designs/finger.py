"""Finger: a cylinder with a rounded tip, a soft skin over a rigid transparent shell.

The shape of GelTip and of most finger-sized sensors: it feels at the tip and all around.

            _.-----._        z = cylinder_mm + tip_ratio * outer_radius_mm
          .' .---. '.
         /  / .-. \\  \\        outside in: elastomer (soft, layers.elastomer_mm),
        |  | |   | |  |       support (rigid, clear, layers.support_mm),
        |  | |   | |  |       cavity (air)
        |  | |   | |  |
     ___|__|_|   |_|__|___   z = 0, base plane: everything above it is cast or sensed
    |      |  cam  |      |
    |______|_______|______|  z = -base_height_mm, the rigid foot with camera and LEDs
           <-- R -->   lip

| parameter         | meaning                                                      |
|-------------------|--------------------------------------------------------------|
| `outer_radius_mm` | outer radius R of the skin                                   |
| `cylinder_mm`     | length of the straight part                                  |
| `tip_ratio`       | tip height over R: 1 hemisphere, less is blunt, more pointed |
| `base_height_mm`  | height of the foot                                           |
| `base_lip_mm`     | how far the foot stands out beyond the skin                  |

The tip is half an ellipsoid of revolution. The core (what is not elastomer) has radius and tip
height smaller by the wall, so the wall is even on the cylinder and at the apex, and on all of a
hemisphere.

Source of the defaults: GelTip, outer radius 15 mm, inner 13 mm, straight part 27 mm (SimTac,
Supplementary). Leaves out: fillets where skin meets foot, screw holes in the foot.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.bodies import Bodies, Fields
from designs.sliders import slider
from geometry.body.outline import upright_and_dome
from workbench.core.base.booleans import cut, expect_volume
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers
from workbench.core.result.marks import Field

CAVITY_RADIUS_MM = 1.0
"""Smallest radius of the cavity that still lets a camera look out [mm]."""
BORE_SHARE = 0.6
"""Radius of the camera bore over the cavity's."""
GELTIP = "GelTip (SimTac, Supplementary)"


@dataclass(frozen=True, kw_only=True, slots=True)
class FingerShape:
    """The finger's own parameters."""

    outer_radius_mm: float = slider(
        15.0, (6.0, 30.0, 0.5), "mm", "Outer radius", "Radius of the skin", GELTIP
    )
    cylinder_mm: float = slider(
        27.0, (2.0, 80.0, 0.5), "mm", "Straight length", "From base to the start of the tip", GELTIP
    )
    tip_ratio: float = slider(
        1.0, (0.5, 1.6, 0.05), "", "Tip ratio", "1 is a hemisphere, less is blunt, more is pointed"
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        3.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the skin"
    )

    @property
    def tip_mm(self) -> float:
        """Height of the tip above the straight part [mm]."""
        return self.tip_ratio * self.outer_radius_mm


@dataclass(frozen=True, kw_only=True, slots=True)
class Finger:
    """Builds fingers."""

    name: str = "finger"
    title: str = "Finger"
    shape_type: type = FingerShape

    def check(self, shape: FingerShape, layers: Layers) -> None:
        """Refuse walls that leave no room inside.

        Raises:
            DesignError: If the elastomer fills the finger, or with the support leaves less than
                1 mm of cavity in radius or tip height.
        """
        room_mm = min(shape.outer_radius_mm, shape.tip_mm)
        room = "outer radius" if room_mm == shape.outer_radius_mm else "tip height"
        wall_mm = layers.elastomer_mm
        both_mm = layers.support_mm + wall_mm
        if wall_mm >= room_mm:
            raise DesignError(
                f"elastomer wall {wall_mm:g} mm is not thinner than the {room} {room_mm:g} mm",
                hint="lower layers.elastomer_mm, or raise shape.outer_radius_mm or shape.tip_ratio",
                at="layers.elastomer_mm",
            )
        if both_mm >= room_mm - CAVITY_RADIUS_MM:
            raise DesignError(
                f"support and elastomer wall together {both_mm:g} mm leave less than "
                f"{CAVITY_RADIUS_MM:g} mm of cavity inside the {room} {room_mm:g} mm",
                hint="lower layers.elastomer_mm or layers.support_mm, or raise "
                "shape.outer_radius_mm or shape.tip_ratio",
                at="layers.elastomer_mm",
            )

    def target(self, shape: FingerShape, layers: Layers) -> tuple[float, float, float]:
        """On the tip, 34 degrees off its axis toward +Y: (0, 10, 35) on the default finger."""
        y = 2.0 / 3.0 * shape.outer_radius_mm
        return 0.0, y, shape.cylinder_mm + shape.tip_mm * 8.0 / 15.0

    def build(self, shape: FingerShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for.
        """
        self.check(shape, layers)
        wall_mm = layers.elastomer_mm
        both_mm = wall_mm + layers.support_mm
        return Bodies(
            membrane=_revolved(shape, 0.0, wall_mm, what="elastomer"),
            outer=_revolved(shape, 0.0, None, what="outer body"),
            core=_revolved(shape, wall_mm, None, what="core"),
            support=_revolved(shape, wall_mm, both_mm, what="support"),
            base=_foot(shape, layers),
        )

    def soften(self, shape: FingerShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def fields(self, shape: FingerShape, layers: Layers) -> Fields:
        """Capsules with an ellipsoidal end as signed distance fields."""
        self.check(shape, layers)
        wall_mm = layers.elastomer_mm
        radius, top = shape.outer_radius_mm, shape.cylinder_mm + shape.tip_mm
        return Fields(
            outer=_field(shape, 0.0),
            core=_field(shape, wall_mm),
            cavity=_field(shape, wall_mm + layers.support_mm),
            base=_foot(shape, layers),
            wall_mm=wall_mm,
            low_mm=(-radius, -radius, 0.0),
            high_mm=(radius, radius, top),
        )


def _field(shape: FingerShape, inset_mm: float) -> Field:
    """Distance to the body whose radius and tip height are smaller by the inset, first order.

    f = k (k - 1) / |grad k| with k the ellipsoid's norm: exact on the surface and its slope.
    """
    radius, tip = shape.outer_radius_mm - inset_mm, shape.tip_mm - inset_mm

    def distance(points_mm: np.ndarray) -> np.ndarray:
        across = np.hypot(points_mm[:, 0], points_mm[:, 1])
        above = np.maximum(points_mm[:, 2] - shape.cylinder_mm, 0.0)
        norm = np.hypot(across / radius, above / tip)
        slope = np.hypot(across / radius**2, above / tip**2)
        return norm * (norm - 1.0) / np.maximum(slope, 1e-9)

    return distance


def capped_cylinder_mm3(shape: FingerShape, inset_mm: float) -> float:
    """Volume of the body whose radius and tip height are smaller by the inset [mm3].

    pi r^2 L + 2/3 pi r^2 h, with r = R - inset, h = tip - inset.
    """
    radius_mm, tip_mm = shape.outer_radius_mm - inset_mm, shape.tip_mm - inset_mm
    return math.pi * radius_mm**2 * (shape.cylinder_mm + 2.0 / 3.0 * tip_mm)


def _revolved(shape: FingerShape, outset_mm: float, inset_mm: float | None, *, what: str) -> Any:
    """The body between two insets, or all of it below the first; checked by its volume.

    Revolving the wall's section equals the outer body minus the core, and spares a boolean of two
    ellipsoids that OCCT needs 0.3 s for.
    """
    from build123d import Axis, Edge, Face, Solid, Wire

    outside, top = _profile(shape, outset_mm)
    expected_mm3 = capped_cylinder_mm3(shape, outset_mm)
    if inset_mm is None:
        inside, bottom = [], (0.0, 0.0, 0.0)
        start = bottom
    else:
        inside, bottom = _profile(shape, inset_mm)
        start = (shape.outer_radius_mm - inset_mm, 0.0, 0.0)
        expected_mm3 -= capped_cylinder_mm3(shape, inset_mm)
    foot = Edge.make_line(start, (shape.outer_radius_mm - outset_mm, 0.0, 0.0))
    edges = [foot, *outside, Edge.make_line(top, bottom), *inside]
    body = Solid.revolve(Face(Wire(edges)), 360.0, Axis.Z)
    return expect_volume(body, expected_mm3, what=what)


def _profile(shape: FingerShape, inset_mm: float) -> tuple[list[Any], tuple[float, float, float]]:
    """Half the outline in the plane y = 0, from the base up, and its apex."""
    radius, tip = shape.outer_radius_mm - inset_mm, shape.tip_mm - inset_mm
    length = shape.cylinder_mm
    return upright_and_dome(radius, length, tip), (0.0, 0.0, length + tip)


def _foot(shape: FingerShape, layers: Layers) -> Any:
    from build123d import Plane, Solid

    height_mm = shape.base_height_mm
    below = Plane(origin=(0, 0, -height_mm))
    cavity_mm = shape.outer_radius_mm - layers.elastomer_mm - layers.support_mm
    disc = Solid.make_cylinder(shape.outer_radius_mm + shape.base_lip_mm, height_mm, below)
    bore = Solid.make_cylinder(BORE_SHARE * cavity_mm, height_mm, below)
    return cut(disc, bore, what="camera bore from the foot")


FAMILY = Finger()
