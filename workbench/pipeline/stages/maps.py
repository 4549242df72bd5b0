"""The stage `maps`: where on the skin a design sees, and how well."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

from sim.optics.field.model import model_of, quick_model
from workbench.core.base.monitor import Monitor
from workbench.core.design.optics import Markers, Optics
from workbench.core.result.light import LightField, NormalTable
from workbench.core.result.maps import DesignerMaps
from workbench.core.result.results import MembraneMesh
from workbench.pipeline.devices import start_device
from workbench.pipeline.seen_optics import seen_optics
from workbench.pipeline.stage import IF_GIVEN, Chain, Stage
from workbench.pipeline.stages import table


@dataclass(frozen=True, kw_only=True, slots=True)
class MapsInputs:
    """What the maps of a design depend on."""

    mesh: MembraneMesh
    light: LightField
    optics: Optics
    young_MPa: float
    table: NormalTable | None = field(default=None, metadata=IF_GIVEN)


def inputs(chain: Chain) -> MapsInputs | None:
    """Those of the design's light."""
    mesh, light = chain.result("mesh"), chain.result("bake")
    return maps_inputs(
        seen_optics(chain.design.optics), mesh, light, chain.design.material.young_MPa
    )


def maps_inputs(
    seen: Optics, mesh: MembraneMesh, light: LightField, young_MPa: float
) -> MapsInputs | None:
    """The inputs for a skin; of photons traced for every frame there is no baked light to map."""
    if model_of(seen.light_model).per_frame:
        return None
    looked_up = table.table_inputs(seen, mesh, light)
    return MapsInputs(
        mesh=mesh,
        light=light,
        optics=dataclasses.replace(
            seen, markers=Markers(), background=None, light_model=quick_model()
        ),
        young_MPa=young_MPa,
        table=None if looked_up is None else table.STAGE.call(looked_up).ref,
    )


def maps(given: MapsInputs, *, monitor: Monitor) -> DesignerMaps:
    """The maps and their scores."""
    start_device(monitor)
    from sim.optics.maps.measure import designer_maps

    return designer_maps(
        given.mesh,
        given.light,
        given.optics,
        given.table,
        young_MPa=given.young_MPa,
        monitor=monitor,
    )


STAGE = Stage(
    name="maps",
    label="Maps",
    # Scores stand in shots, too: raise the version of `shoot` with this one.
    version=6,
    place=13,
    lane="sim",
    run=maps,
    inputs=inputs,
    on_strip=True,
)
