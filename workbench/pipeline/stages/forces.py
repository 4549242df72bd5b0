"""The stage `forces`: what finite elements found, on the skin of the design."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from workbench.core.base.monitor import Monitor
from workbench.core.result.force_field import ForceField
from workbench.core.result.results import MembraneMesh, Solid
from workbench.pipeline.stage import PART, Call, Chain, Stage
from workbench.pipeline.stages.mesh import mesh_at
from workbench.pipeline.store import Store


@dataclass(frozen=True, kw_only=True, slots=True)
class ForcesInputs:
    """What is carried from which mesh to which."""

    mesh: MembraneMesh
    """Of the design, on whose skin forces are shown."""
    solid: Solid
    hex_mm: float
    """Spacing of the mesh that `found` was found on."""
    found: ForceField
    source: MembraneMesh | None = field(default=None, metadata=PART)
    """That mesh."""


def inputs(chain: Chain) -> ForcesInputs:
    """The result of finite elements and the design's mesh."""
    return ForcesInputs(
        mesh=chain.result("mesh"),
        solid=chain.result("build"),
        hex_mm=chain.case.fem.hex_mm,
        found=chain.result("fem"),
    )


def parts(given: ForcesInputs, store: Store) -> dict[str, Call]:
    """The mesh that the result was found on."""
    return {"source": mesh_at(given.solid, given.hex_mm)}


def forces(given: ForcesInputs, *, monitor: Monitor) -> ForceField:
    """The same forces on the skin of the design."""
    from sim.forces.transfer import transferred

    source: Any = given.source
    return transferred(given.found, source, given.mesh)


STAGE = Stage(
    name="forces",
    label="Forces",
    version=3,
    place=9,
    lane="sim",
    run=forces,
    inputs=inputs,
    parts=parts,
    heavy=True,
)
