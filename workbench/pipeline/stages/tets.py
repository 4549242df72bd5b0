"""The stage `tets`: a body to tetrahedra."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.results import Solid, VolumeMesh
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class TetsInputs:
    """What tetrahedra depend on."""

    solid: Solid
    edge_mm: float


def inputs(chain: Chain) -> TetsInputs:
    """The body, at the design's edge length."""
    return TetsInputs(solid=chain.result("build"), edge_mm=chain.design.meshing.tet_mm)


def tets(given: TetsInputs, *, monitor: Monitor) -> VolumeMesh:
    """Tetrahedra of a body."""
    from geometry.volume.tets import tetrahedra

    return tetrahedra(given.solid, given.edge_mm, monitor=monitor)


STAGE = Stage(
    name="tets", label="Tetrahedra", version=1, place=19, lane="cad", run=tets, inputs=inputs
)
