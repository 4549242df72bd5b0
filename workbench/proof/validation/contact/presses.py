"""Presses of the default finger that several rooms look at."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable

from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.result.sensing import Contact
from workbench.pipeline.devices import open_device
from workbench.pipeline.stages.press import PressInputs, press
from workbench.proof.specimens import finger_mesh, finger_points

TIP_CENTRE_MM = 27.0
RADIUS_MM = 15.0
REGION_MM = 12.0
GRID_MM = 0.5
NAME = "finger_45: sphere R 3 mm, tip at 45 degrees, E .145 MPa, nu .45, mu .3, 1 mm deep"


def on_device(value: Callable[[], float]) -> Callable[[], float]:
    """The measurement with Taichi opened first, in the thread that computes."""

    def measured() -> float:
        open_device()
        return value()

    return measured


def tip_target(polar_deg: float, azimuth_deg: float) -> tuple[float, float, float]:
    """Point of the hemispherical tip, by angle from +Z and azimuth from +X [mm]."""
    polar, azimuth = math.radians(polar_deg), math.radians(azimuth_deg)
    aside = RADIUS_MM * math.sin(polar)
    return (
        aside * math.cos(azimuth),
        aside * math.sin(azimuth),
        TIP_CENTRE_MM + RADIUS_MM * math.cos(polar),
    )


@functools.cache
def finger_press(
    *,
    azimuth_deg: float = 0.0,
    young_MPa: float = 0.145,
    shear_mm: tuple[float, float] = (0.0, 0.0),
    friction: float = 0.3,
) -> Contact:
    """The press `finger_45` of the validation, varied."""
    return press(
        PressInputs(
            mesh=finger_mesh(),
            points=finger_points(GRID_MM),
            material=Elastomer(young_MPa=young_MPa, friction=friction),
            indenter=Indenter(size_mm=6.0),
            path=Press(target_mm=tip_target(45.0, azimuth_deg), shear_mm=shear_mm, frames=1),
            settings=ContactSettings(grid_mm=GRID_MM, active_radius_mm=REGION_MM),
        ),
        monitor=silent,
    )
