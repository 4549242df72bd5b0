"""Pad: a flat or slightly domed slab of gel on a clear plate, seen by a camera from below.

The shape of GelSight and of most gripper-pad sensors.

                _______________
            .-''               ''-.    z = standoff_mm + elastomer_mm + dome_mm at the middle
           |_______________________|   elastomer: its flat underside is bonded to the plate
           |  ___________________  |   z = standoff_mm, top of the plate
           | |                   | |   support: clear plate and walls, layers.support_mm thick
           | |   cavity (air)    | |
           | |                   | |
        ___|_|_______ o _________|_|___   z = 0: LEDs and camera
       |          |  cam |             |
       |__________|______|_____________|  z = -base_height_mm, the rigid foot

| parameter        | meaning                                                       |
|------------------|---------------------------------------------------------------|
| `width_mm`       | size along X                                                  |
| `depth_mm`       | size along Y                                                  |
| `corner_mm`      | radius of the four upright edges                              |
| `dome_mm`        | rise of the middle over the corners; 0 is flat                |
| `standoff_mm`    | height of the plate's top over the camera                     |
| `base_height_mm` | height of the foot                                            |
| `base_lip_mm`    | how far the foot stands out beyond the gel                    |

The dome is part of a sphere that meets the upright edges of the slab at `layers.elastomer_mm`, so
the gel is thinnest there. Its sides are free; only the underside is bonded.

Sources: GelSight (Yuan and others, Sensors 2017): a gel slab on an acrylic plate with the camera
behind it. The defaults are the flat block of the released SimTac GelSight, 20 x 20 x 4 mm (MIT),
its upright edges rounded by half a millimetre for the mould.
Leaves out: bevelled gel rims, tilted cameras and mirrors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from designs.bodies import Bodies, Fields
from designs.plates import bored_plate, rectangle_distance, rounded_prism
from designs.sliders import slider
from workbench.core.base.booleans import cut, expect_volume, fuse, intersect
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers
from workbench.core.result.marks import Field

CAVITY_MM = 4.0
"""Smallest width, depth and height of the cavity: a camera and LEDs must fit [mm]."""
GELSIGHT = "GelSight (Yuan and others, Sensors 2017)"


@dataclass(frozen=True, kw_only=True, slots=True)
class PadShape:
    """The pad's own parameters."""

    width_mm: float = slider(20.0, (10.0, 60.0, 0.5), "mm", "Width", "Size along X")
    depth_mm: float = slider(20.0, (10.0, 60.0, 0.5), "mm", "Depth", "Size along Y")
    corner_mm: float = slider(
        0.5, (0.25, 8.0, 0.25), "mm", "Corner radius", "Radius of the upright edges"
    )
    dome_mm: float = slider(
        0.0, (0.0, 4.0, 0.1), "mm", "Dome", "Rise of the middle over the corners; 0 is flat"
    )
    standoff_mm: float = slider(
        18.0, (8.0, 50.0, 0.5), "mm", "Standoff", "From camera to the top of the plate", GELSIGHT
    )
    base_height_mm: float = slider(
        8.0, (2.0, 40.0, 0.5), "mm", "Foot height", "Rigid foot that carries camera and LEDs"
    )
    base_lip_mm: float = slider(
        2.0, (0.0, 15.0, 0.5), "mm", "Foot lip", "How far the foot stands out beyond the gel"
    )

    @property
    def half_diagonal_mm(self) -> float:
        """From the axis to the farthest point of a rounded corner [mm]."""
        straight = math.hypot(
            self.width_mm / 2 - self.corner_mm, self.depth_mm / 2 - self.corner_mm
        )
        return straight + self.corner_mm

    @property
    def sphere_mm(self) -> float:
        """Radius of the dome [mm]: R = (a^2 + h^2) / (2 h); infinite when flat."""
        rise = self.dome_mm
        return (self.half_diagonal_mm**2 + rise**2) / (2 * rise) if rise else math.inf


@dataclass(frozen=True, kw_only=True, slots=True)
class Pad:
    """Builds pads."""

    name: str = "pad"
    title: str = "Pad"
    shape_type: type = PadShape

    def check(self, shape: PadShape, layers: Layers) -> None:
        """Refuse corners that meet, and plates that fill the cavity.

        Raises:
            DesignError: Naming the field, its value and its limit.
        """
        narrow_mm = min(shape.width_mm, shape.depth_mm)
        if 2 * shape.corner_mm >= narrow_mm:
            raise DesignError(
                f"corner radius {shape.corner_mm:g} mm is not less than half the smaller side, "
                f"{narrow_mm / 2:g} mm",
                hint="lower shape.corner_mm, or raise shape.width_mm and shape.depth_mm",
                at="shape.corner_mm",
            )
        room_mm = min(narrow_mm - 2 * layers.support_mm, shape.standoff_mm - layers.support_mm)
        if room_mm < CAVITY_MM:
            raise DesignError(
                f"a support of {layers.support_mm:g} mm leaves {room_mm:g} mm of cavity, less "
                f"than {CAVITY_MM:g} mm",
                hint="lower layers.support_mm, or raise shape.standoff_mm, shape.width_mm and "
                "shape.depth_mm",
                at="layers.support_mm",
            )

    def soften(self, shape: PadShape) -> None:
        """There is no fillet to make smaller."""
        return None

    def target(self, shape: PadShape, layers: Layers) -> tuple[float, float, float]:
        """The middle of the gel."""
        return 0.0, 0.0, shape.standoff_mm + layers.elastomer_mm + shape.dome_mm

    def build(self, shape: PadShape, layers: Layers) -> Bodies:
        """Build the five bodies.

        Raises:
            DesignError: As `check`.
            GeometryError: If the CAD kernel returned something else than asked for.
        """
        self.check(shape, layers)
        plate_mm = shape.standoff_mm
        membrane = _slab(shape, layers, plate_mm)
        core = _prism(shape, 0.0, 0.0, plate_mm)
        cavity = _prism(shape, layers.support_mm, 0.0, plate_mm - layers.support_mm)
        return Bodies(
            membrane=membrane,
            outer=_slab(shape, layers, 0.0),
            core=core,
            support=cut(core, cavity, what="cavity from the support"),
            base=_foot(shape, layers),
        )

    def fields(self, shape: PadShape, layers: Layers) -> Fields:
        """Rounded prisms under a sphere as signed distance fields."""
        self.check(shape, layers)
        plate_mm, inset_mm = shape.standoff_mm, layers.support_mm
        top_mm = plate_mm + layers.elastomer_mm + shape.dome_mm
        half_x, half_y = shape.width_mm / 2, shape.depth_mm / 2
        return Fields(
            outer=_domed(shape, top_mm),
            core=_flat(shape, 0.0, plate_mm),
            cavity=_flat(shape, inset_mm, plate_mm - inset_mm),
            base=_foot(shape, layers),
            low_mm=(-half_x, -half_y, 0.0),
            high_mm=(half_x, half_y, top_mm),
        )


def slab_mm3(shape: PadShape, layers: Layers) -> float:
    """Volume of the gel [mm3]: the prism under the dome, by Gauss quadrature over its area.

    height(x, y) = elastomer + dome - R + sqrt(R^2 - x^2 - y^2); exact to about 1e-9 for any dome.
    """
    half_x, half_y, corner = shape.width_mm / 2, shape.depth_mm / 2, shape.corner_mm
    area = shape.width_mm * shape.depth_mm - (4 - math.pi) * corner**2
    flat = (layers.elastomer_mm + shape.dome_mm) * area
    if shape.dome_mm == 0.0:
        return flat
    nodes, weights = np.polynomial.legendre.leggauss(40)
    # A quarter of the outline in strips along X, split where the corner begins.
    total = 0.0
    for low, high in ((0.0, half_y - corner), (half_y - corner, half_y)):
        y = (low + high) / 2 + (high - low) / 2 * np.sin(np.pi / 2 * nodes)
        stretch = (high - low) / 2 * np.pi / 2 * np.cos(np.pi / 2 * nodes)
        over = np.maximum(y - (half_y - corner), 0.0)
        reach = half_x - corner + np.sqrt(np.maximum(corner**2 - over**2, 0.0))
        x = reach[:, None] * (nodes + 1) / 2
        sag = shape.sphere_mm - np.sqrt(shape.sphere_mm**2 - x**2 - y[:, None] ** 2)
        total += float((weights * stretch) @ (reach / 2 * (sag @ weights)))
    return flat - 4 * total


def _slab(shape: PadShape, layers: Layers, from_mm: float) -> Any:
    """The gel and what is below it, from a height up."""
    from build123d import Pos, Sphere

    top_mm = shape.standoff_mm + layers.elastomer_mm + shape.dome_mm
    if shape.dome_mm > 0.0:
        middle_mm = top_mm - shape.sphere_mm
        # Below its middle the sphere narrows again and would cut off what the gel stands on.
        foot_mm = max(from_mm, middle_mm)
        dome = Pos(0, 0, middle_mm) * Sphere(shape.sphere_mm)
        body = intersect(_prism(shape, 0.0, foot_mm, top_mm), dome, what="dome of the gel")
        if foot_mm > from_mm:
            below = _prism(shape, 0.0, from_mm, foot_mm)
            body = fuse(below, body, what="dome to what is below it")
    else:
        body = _prism(shape, 0.0, from_mm, top_mm)
    area = shape.width_mm * shape.depth_mm - (4 - math.pi) * shape.corner_mm**2
    expected_mm3 = slab_mm3(shape, layers) + area * (shape.standoff_mm - from_mm)
    return expect_volume(body, expected_mm3, what="gel slab", relative=1e-5)


def _prism(shape: PadShape, inset_mm: float, from_mm: float, to_mm: float) -> Any:
    size = shape.width_mm - 2 * inset_mm, shape.depth_mm - 2 * inset_mm
    return rounded_prism(*size, _corner_mm(shape, inset_mm), from_mm, to_mm)


def _corner_mm(shape: PadShape, inset_mm: float) -> float:
    """Radius of an inset corner: parallel where there is room, else small but round."""
    return max(shape.corner_mm - inset_mm, 0.5)


def _foot(shape: PadShape, layers: Layers) -> Any:
    lip_mm = shape.base_lip_mm
    plate = rounded_prism(
        shape.width_mm + 2 * lip_mm,
        shape.depth_mm + 2 * lip_mm,
        shape.corner_mm + lip_mm,
        -shape.base_height_mm,
        0.0,
    )
    cavity_mm = min(shape.width_mm, shape.depth_mm) / 2 - layers.support_mm
    return bored_plate(plate, cavity_mm, shape.base_height_mm)


def _flat(shape: PadShape, inset_mm: float, top_mm: float) -> Field:
    half = shape.width_mm / 2 - inset_mm, shape.depth_mm / 2 - inset_mm
    corner_mm = _corner_mm(shape, inset_mm)

    def distance(points_mm: np.ndarray) -> np.ndarray:
        beside = rectangle_distance(points_mm[:, :2], *half, corner_mm)
        return np.maximum(beside, points_mm[:, 2] - top_mm)

    return distance


def _domed(shape: PadShape, top_mm: float) -> Field:
    prism = _flat(shape, 0.0, top_mm)
    if shape.dome_mm == 0.0:
        return prism
    centre = np.array([0.0, 0.0, top_mm - shape.sphere_mm])

    def distance(points_mm: np.ndarray) -> np.ndarray:
        # Below its middle the sphere goes on as a cylinder, which is wider than the prism.
        above = np.maximum(points_mm - centre, [-np.inf, -np.inf, 0.0])
        return np.maximum(prism(points_mm), np.linalg.norm(above, axis=1) - shape.sphere_mm)

    return distance


FAMILY = Pad()
