"""The stage `mesh`: a body to hexahedra and uniform skins."""

from __future__ import annotations

from dataclasses import dataclass, field

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Meshing
from workbench.core.result.results import MembraneMesh, Solid
from workbench.pipeline.stage import Call, Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class MeshInputs:
    """What the meshes of a body depend on."""

    solid: Solid
    meshing: Meshing
    paired: bool = field(default=False, metadata={"later": True})
    """Whether eight cells each make a larger one."""


def inputs(chain: Chain) -> MeshInputs:
    """The body, at the design's spacing."""
    return MeshInputs(solid=chain.result("build"), meshing=chain.design.meshing)


def mesh_at(solid: Solid, hex_mm: float) -> Call:
    """The call for the mesh of finite elements, and of networks that were trained on it."""
    return STAGE.call(MeshInputs(solid=solid, meshing=Meshing(hex_mm=hex_mm), paired=True))


def mesh(given: MeshInputs, *, monitor: Monitor) -> MembraneMesh:
    """Hexahedra and skins."""
    from geometry.volume.hexmesh import mesh_membrane

    return mesh_membrane(given.solid, given.meshing, monitor=monitor, paired=given.paired)


STAGE = Stage(
    name="mesh",
    label="Mesh",
    version=2,
    place=2,
    lane="cad",
    run=mesh,
    inputs=inputs,
    in_run=True,
    on_strip=True,
)
