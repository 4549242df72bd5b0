"""The stage `lattice`: a body to material points on a reference lattice."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.result.results import MaterialPoints, Solid
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class LatticeInputs:
    """What material points depend on."""

    solid: Solid
    grid_mm: float


def inputs(chain: Chain) -> LatticeInputs:
    """The body, at the contact solver's grid."""
    return LatticeInputs(solid=chain.result("build"), grid_mm=chain.case.settings.grid_mm)


def lattice(given: LatticeInputs, *, monitor: Monitor) -> MaterialPoints:
    """Material points of a body."""
    from geometry.volume.lattice import material_points

    return material_points(given.solid.membrane, given.grid_mm, monitor=monitor)


STAGE = Stage(
    name="lattice",
    label="Material points",
    version=2,
    place=3,
    lane="cad",
    run=lattice,
    inputs=inputs,
    in_run=True,
    shown=False,
)
