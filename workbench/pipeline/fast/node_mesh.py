"""The stage `node_mesh`: the mesh whose outer vertices are the nodes of fast contact."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import Meshing
from workbench.core.result.results import MembraneMesh, Solid
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class NodeMeshInputs:
    """What the nodes depend on."""

    solid: Solid
    wall_mm: float
    """Elastomer of the design: thin walls need closer nodes."""


def inputs(chain: Chain) -> NodeMeshInputs:
    """The body and its wall."""
    return NodeMeshInputs(solid=chain.result("build"), wall_mm=chain.design.layers.elastomer_mm)


def node_mesh(given: NodeMeshInputs, *, monitor: Monitor) -> MembraneMesh:
    """The mesh; refuses membranes that fast contact does not know."""
    from geometry.volume.hexmesh import mesh_membrane
    from sim.condensed.tiles import check_condensable, node_mm

    found = mesh_membrane(given.solid, Meshing(hex_mm=node_mm(given.wall_mm)), monitor=monitor)
    check_condensable(found)
    return found


STAGE = Stage(
    name="node_mesh",
    label="Nodes of fast contact",
    version=1,
    place=23,
    lane="cad",
    run=node_mesh,
    inputs=inputs,
    shown=False,
)
