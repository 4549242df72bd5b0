"""The stage `intake`: the designer's file to closed surfaces, repaired where that is safe."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

from workbench.core.base.monitor import Monitor
from workbench.core.design.imported import IMPORTED, ImportedBody, ReadBody
from workbench.pipeline.stage import Chain, Stage


@dataclass(frozen=True, kw_only=True, slots=True)
class IntakeInputs:
    """What reading a file depends on."""

    body: ImportedBody
    """The file, without the faces that were picked on it."""


def inputs(chain: Chain) -> IntakeInputs | None:
    """The file of a design with a body of its own."""
    design = chain.design
    if design.body is None or design.family != IMPORTED:
        return None
    return IntakeInputs(body=dataclasses.replace(design.body, picks=()))


def intake(given: IntakeInputs, *, monitor: Monitor) -> ReadBody:
    """The designer's file to closed surfaces."""
    from geometry.intake.intake import read_body

    return read_body(given.body, monitor)


STAGE = Stage(
    name="intake",
    label="File",
    version=2,
    place=0,
    lane="cad",
    run=intake,
    inputs=inputs,
    shown=False,
)
