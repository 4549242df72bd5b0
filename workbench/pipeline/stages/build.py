"""The stage `build`: parameters, or a body that was read, to a labelled body."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Layers
from workbench.core.design.imported import Pick, ReadBody
from workbench.core.result.results import Solid
from workbench.pipeline.stage import IF_GIVEN, Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class BuildInputs:
    """What a body depends on."""

    family: str
    shape: Any
    """Dataclass of the family's parameters."""
    layers: Layers
    body: ReadBody | None = field(default=None, metadata=IF_GIVEN)
    picks: tuple[Pick, ...] | None = field(default=None, metadata=IF_GIVEN)
    """Faces of the body that the designer named; None where there is no such body."""


def inputs(chain: Chain) -> BuildInputs:
    """The parameters of the family, or the body that was read."""
    design, body = chain.design, chain.result("intake")
    picks = None if body is None or design.body is None else design.body.picks
    return BuildInputs(
        family=design.family, shape=chain.shape, layers=design.layers, body=body, picks=picks
    )


def build(given: BuildInputs, *, monitor: Monitor) -> Solid:
    """The body of the membrane."""
    if given.body is not None:
        from geometry.intake.imported import build_imported

        return build_imported(given.body, given.shape, given.layers, given.picks or (), monitor)
    from designs.family import family
    from workbench.pipeline.building import build_solid

    return build_solid(family(given.family), given.shape, given.layers)


STAGE = Stage(
    name="build",
    label="Shape",
    version=3,
    place=1,
    lane="cad",
    run=build,
    inputs=inputs,
    in_run=True,
    on_strip=True,
)
