"""The stage `mould`: the printable mould of a body."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.design.design import MouldOptions
from workbench.core.result.fabrication import MouldSet
from workbench.core.result.results import Solid
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class MouldInputs:
    """What a mould depends on."""

    solid: Solid
    options: MouldOptions


def inputs(chain: Chain) -> MouldInputs:
    """The body and how it is cast."""
    return MouldInputs(solid=chain.result("build"), options=chain.design.mould)


def mould(given: MouldInputs, *, monitor: Monitor) -> MouldSet:
    """The parts of the mould."""
    from geometry.mould.moulds import make_mould

    return make_mould(given.solid, given.options, monitor=monitor)


STAGE = Stage(
    name="mould",
    label="Mould",
    version=4,
    place=14,
    lane="cad",
    run=mould,
    inputs=inputs,
    in_run=True,
    on_strip=True,
)
