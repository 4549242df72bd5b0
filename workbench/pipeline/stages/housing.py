"""The stage `housing`: the rigid parts of the sensor."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.digest import at_defaults
from workbench.core.base.monitor import Monitor
from workbench.core.design.camera import Camera
from workbench.core.design.lighting import LedRing
from workbench.core.design.making import Housing, Printer
from workbench.core.result.fabrication import HousingSet
from workbench.core.result.results import Solid
from workbench.pipeline.stage import Chain, Stage
from workbench.pipeline.stages.recipe import bought


@dataclass(frozen=True, kw_only=True, slots=True)
class HousingInputs:
    """What the rigid parts depend on: of camera and ring only what has a size or a place."""

    solid: Solid
    options: Housing
    ring: LedRing
    camera_mm: tuple[float, float, float]
    camera_wxyz: tuple[float, float, float, float]
    printer: Printer


def inputs(chain: Chain) -> HousingInputs:
    """The body, what it holds and what prints it."""
    design, camera = chain.design, chain.design.optics.camera
    return HousingInputs(
        solid=chain.result("build"),
        options=design.housing,
        ring=at_defaults(bought(design.optics.ring), "colours"),
        camera_mm=camera.position_mm,
        camera_wxyz=camera.wxyz,
        printer=design.mould.printer,
    )


def housing(given: HousingInputs, *, monitor: Monitor) -> HousingSet:
    """The rigid parts."""
    from geometry.housing.housing import make_housing

    return make_housing(
        given.solid,
        given.options,
        ring=given.ring,
        camera=Camera(position_mm=given.camera_mm, wxyz=given.camera_wxyz),
        printer=given.printer,
        monitor=monitor,
    )


STAGE = Stage(
    name="housing",
    label="Housing",
    version=4,
    place=15,
    lane="cad",
    run=housing,
    inputs=inputs,
    in_run=True,
)
