"""The stage `fem`: the same press by finite elements, on a mesh of its own: slow, and the truth."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Elastomer
from workbench.core.press.fem import FemSettings
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh, Solid
from workbench.core.result.sampled import SampledDistance
from workbench.pipeline.devices import solver_device, start_device
from workbench.pipeline.stage import PART, Call, Chain, Stage
from workbench.pipeline.stages import object as object_stage
from workbench.pipeline.stages.mesh import mesh_at
from workbench.pipeline.stages.press import elastic
from workbench.pipeline.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class FemInputs:
    """What finite elements depend on."""

    solid: Solid
    material: Elastomer
    indenter: Indenter
    path: Press
    settings: FemSettings
    mesh: MembraneMesh | None = field(default=None, metadata=PART)
    """At the spacing of `settings`."""
    sampled: SampledDistance | None = field(default=None, metadata=PART)


def inputs(chain: Chain) -> FemInputs:
    """The body, the object and its path."""
    return FemInputs(
        solid=chain.result("build"),
        material=elastic(chain.design.material),
        indenter=chain.case.indenter,
        path=chain.case.press,
        settings=chain.case.fem,
    )


def parts(given: FemInputs, store: Store) -> dict[str, Call]:
    """The mesh, and the object's distance where that takes long to sample."""
    from sim.fem.press import sampling_grid_mm

    calls = {"mesh": mesh_at(given.solid, given.settings.hex_mm)}
    if object_stage.sampled_long(given.indenter):
        calls["sampled"] = object_stage.STAGE.call(
            object_stage.ObjectInputs(
                indenter=given.indenter, grid_mm=sampling_grid_mm(given.settings)
            )
        )
    return calls


def fem(given: FemInputs, *, monitor: Monitor) -> ForceField:
    """Forces and displacement on the mesh of finite elements."""
    start_device(monitor)
    from sim.fem.press import solve_press

    found: Any = given.mesh
    return solve_press(
        found,
        given.material,
        PressCase(indenter=given.indenter, press=given.path, fem=given.settings),
        sampled=given.sampled,
        device=solver_device(),
        monitor=monitor,
    )


STAGE = Stage(
    name="fem",
    label="Finite elements",
    version=4,
    place=8,
    lane="sim",
    run=fem,
    inputs=inputs,
    parts=parts,
    shown=False,
)
