"""The stage `picture`: mould and sensor drawn apart, for the report."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.fabrication import HousingSet, MouldSet
from workbench.core.result.results import Picture, Solid
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class DrawingInputs:
    """What is drawn."""

    solid: Solid
    moulds: MouldSet
    housing: HousingSet


def inputs(chain: Chain) -> DrawingInputs:
    """The body and all parts around it."""
    return DrawingInputs(
        solid=chain.result("build"), moulds=chain.result("mould"), housing=chain.result("housing")
    )


def drawing(given: DrawingInputs, *, monitor: Monitor) -> Picture:
    """The drawing; a DeviceError where nothing can render."""
    from geometry.drawing.sensor_drawings import exploded_sensor

    return Picture(png=exploded_sensor(given.solid, given.moulds, given.housing))


STAGE = Stage(
    # Drawings lie in stores and in keys under this name.
    name="picture",
    label="Drawing",
    version=2,
    place=20,
    lane="cad",
    run=drawing,
    inputs=inputs,
    shown=False,
)
