"""The stage `quality`: how good the meshes of a body are."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.quality import QualityReport
from workbench.core.result.results import MembraneMesh, Solid
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class QualityInputs:
    """What is judged."""

    solid: Solid
    mesh: MembraneMesh


def inputs(chain: Chain) -> QualityInputs:
    """The body and its meshes."""
    return QualityInputs(solid=chain.result("build"), mesh=chain.result("mesh"))


def quality(given: QualityInputs, *, monitor: Monitor) -> QualityReport:
    """How good the meshes are."""
    from geometry.volume.quality import quality_report

    return quality_report(given.mesh, given.solid.volume_mm3)


STAGE = Stage(
    name="quality",
    label="Mesh quality",
    version=1,
    place=18,
    lane="cad",
    run=quality,
    inputs=inputs,
)
