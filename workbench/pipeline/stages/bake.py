"""The stage `bake`: light of each LED at each vertex of the skin."""

from __future__ import annotations

from dataclasses import dataclass

from sim.optics.field.model import model_of
from workbench.core.base.monitor import Monitor
from workbench.core.design.lighting import Lamp, LedRing, LightModel
from workbench.core.design.optics import Transport
from workbench.core.result.light import LightField
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import start_device
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class BakeInputs:
    """What light on the skin depends on."""

    mesh: MembraneMesh
    ring: LedRing
    lamps: tuple[Lamp, ...]
    model: LightModel
    transport: Transport | None = None
    """Coating and refractive index, for traced light only."""


def inputs(chain: Chain) -> BakeInputs:
    """Skin and lights; of what light meets on its way only what the model reads."""
    optics = chain.design.optics
    return BakeInputs(
        mesh=chain.result("mesh"),
        ring=optics.ring,
        lamps=optics.lamps,
        model=optics.light_model,
        transport=optics.transport if model_of(optics.light_model).tabulated else None,
    )


def bake(given: BakeInputs, *, monitor: Monitor) -> LightField:
    """Light on the skin."""
    from sim.optics.field.bake import bake_light

    if given.transport is not None:
        start_device(monitor)
    return bake_light(
        given.mesh,
        given.ring,
        given.lamps,
        model=given.model,
        transport=given.transport,
        monitor=monitor,
    )


STAGE = Stage(
    name="bake",
    label="Light",
    version=4,
    place=4,
    lane="sim",
    run=bake,
    inputs=inputs,
    in_run=True,
    on_strip=True,
    shown=False,
)
