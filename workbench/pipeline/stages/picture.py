"""The stage `picture`: mould and sensor drawn apart, for the report."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.fabrication import HousingSet, MouldSet
from workbench.core.result.results import Picture, Solid
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class PictureInputs:
    """What is drawn."""

    solid: Solid
    moulds: MouldSet
    housing: HousingSet


def inputs(chain: Chain) -> PictureInputs:
    """The body and all parts around it."""
    return PictureInputs(
        solid=chain.result("build"), moulds=chain.result("mould"), housing=chain.result("housing")
    )


def picture(given: PictureInputs, *, monitor: Monitor) -> Picture:
    """The drawing; a DeviceError where nothing can render."""
    from geometry.picture.pictures import exploded_sensor

    return Picture(png=exploded_sensor(given.solid, given.moulds, given.housing))


STAGE = Stage(
    name="picture",
    label="Drawing",
    version=2,
    place=20,
    lane="cad",
    run=picture,
    inputs=inputs,
    shown=False,
)
