"""All stages by name, in the order of their places: found in the packages that hold them."""

from __future__ import annotations

from workbench.core.base.records import records
from workbench.pipeline.stage import Stage

PACKAGES = ("workbench.pipeline.stages", "workbench.pipeline.fast")
STAGES: dict[str, Stage] = {
    stage.name: stage
    for stage in sorted(
        (stage for package in PACKAGES for stage in records(package, "STAGE").values()),
        key=lambda stage: stage.place,
    )
}
IN_RUN = tuple(stage.name for stage in STAGES.values() if stage.in_run)
"""Stages of a whole run, in order."""


def label_of(stage: str) -> str:
    """What people read of a stage; other work that a worker does has its own name."""
    return STAGES[stage].label if stage in STAGES else stage
