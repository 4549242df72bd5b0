"""The stage `object`: the signed distance of an object made of triangles or with a texture."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.digest import at_defaults
from workbench.core.base.monitor import Monitor
from workbench.core.press.indenter import Indenter
from workbench.core.result.sampled import SampledDistance
from workbench.pipeline.devices import open_device
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class ObjectInputs:
    """What a sampled distance depends on."""

    indenter: Indenter
    grid_mm: float


def inputs(chain: Chain) -> ObjectInputs | None:
    """The object at the contact solver's grid, where its distance takes long to sample."""
    indenter = chain.case.indenter
    if not sampled_long(indenter):
        return None
    return ObjectInputs(indenter=shape_only(indenter), grid_mm=chain.case.settings.grid_mm)


def sampled_long(indenter: Indenter) -> bool:
    """Whether sampling the distance takes up to a minute, so that it is kept."""
    return indenter.mesh is not None or indenter.texture.raised


def shape_only(indenter: Indenter) -> Indenter:
    """An object without what its signed distance does not read."""
    unread = ("soft", "edge_radius_mm") if indenter.record.edge_share is None else ("soft",)
    return at_defaults(indenter, *unread)


def object_distance(given: ObjectInputs, *, monitor: Monitor) -> SampledDistance:
    """Signed distance of an object on a grid."""
    monitor(0.0, "sampling the object")
    open_device()
    from sim.contact.objects.sampling import sample_indenter

    return sample_indenter(given.indenter, grid_mm=given.grid_mm)


STAGE = Stage(
    name="object",
    label="Object",
    version=1,
    place=6,
    lane="sim",
    run=object_distance,
    inputs=inputs,
    shown=False,
)
