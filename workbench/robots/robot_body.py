"""What a robot's program is told of a sensor: its rigid parts, its elastomer, skin and camera.

The membrane counts as rigid and does not move against the parts that carry it. What has no body in
a design has no mass here: camera module, LEDs, cables, screws.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.core.result.fabrication import FabricationPart, HousingSet
from workbench.core.result.results import Skin, Solid
from workbench.robots.inertia import Inertia, of_body

RESIN_g_cm3 = 1.18
"""Clear resin, cured. Source: Stratasys VeroClear RGD810 data sheet, 1.18 to 1.19."""
PRINT_g_cm3 = 1.24
"""Opaque print, solid. Source: NatureWorks Ingeo 4043D (PLA) data sheet."""
CLEAR = "clear resin"
"""In the process of parts that light passes."""


@dataclass(frozen=True, kw_only=True, slots=True)
class RobotPart:
    """A closed body of one material, in its place in the sensor's frame."""

    name: str
    points_mm: np.ndarray
    """Vertices, shape (N, 3)."""
    faces: np.ndarray
    """Triangles, shape (M, 3), int32."""
    density_g_cm3: float
    clear: bool = False
    """Whether light passes it."""

    def inertia(self) -> Inertia:
        """Its mass, centre and inertia."""
        return of_body(self.points_mm, self.faces, self.density_g_cm3)


@dataclass(frozen=True, kw_only=True, slots=True)
class RobotBody:
    """A sensor; its frame is that of `wb.Sensor`: origin at the centre of the base, +Z to the
    tip."""

    name: str
    """Letters, digits and underscores."""
    rigid: tuple[RobotPart, ...]
    """Parts that carry the membrane; the last is the foot that a robot holds."""
    membrane: RobotPart
    skin: Skin
    """The outer skin whose vertices are taxels."""
    camera: Camera
    friction: float
    """Coulomb coefficient of the skin [1]."""

    @property
    def foot(self) -> RobotPart:
        """What a robot holds."""
        return self.rigid[-1]

    @property
    def mount_mm(self) -> np.ndarray:
        """Below the foot, on the sensor's axis, shape (3,): where a robot holds it."""
        return np.array([0.0, 0.0, float(self.foot.points_mm[:, 2].min())])


def robot_body(design: SensorDesign, solid: Solid, housing: HousingSet, skin: Skin) -> RobotBody:
    """A design's body, of the results of its stages `build` and `housing` and a skin."""
    *others, foot = sorted(housing.parts, key=lambda part: part.name == FOOT)
    return RobotBody(
        name=plain_name(design.name),
        rigid=tuple(_printed(part) for part in (*others, foot)),
        membrane=RobotPart(
            name="membrane",
            points_mm=solid.membrane.points_mm,
            faces=solid.membrane.faces,
            density_g_cm3=design.material.density_g_cm3,
        ),
        skin=skin,
        camera=design.optics.camera,
        friction=design.material.friction,
    )


FOOT = "housing_base"
"""The part of a housing that a robot holds."""


def plain_name(name: str) -> str:
    """A name that URDF and ROS take: letters, digits, underscores, no digit first."""
    found = re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_").lower()
    return found if found[:1].isalpha() else f"sensor_{found}".rstrip("_")


def _printed(part: FabricationPart) -> RobotPart:
    clear = CLEAR in part.process
    return RobotPart(
        name=part.name,
        points_mm=part.points_mm,
        faces=part.faces,
        density_g_cm3=RESIN_g_cm3 if clear else PRINT_g_cm3,
        clear=clear,
    )
