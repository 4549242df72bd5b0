"""Which tasks of which designs are on record, and on what each record rests."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from workbench.system.record import Record

FOLDER = Path(__file__).parent
COMMAND = "python -m workbench.proof.validation.tasks.task_figures FOLDER"
FINGER, PAD = "geltip", "pad"
SIZES = ("small", "paper")
DONE = {
    "small": tuple((FINGER, task) for task in ("objects", "slip", "safety", "pose", "force")),
    "paper": ((FINGER, "objects"), (FINGER, "slip"), (PAD, "safety")),
}
"""All tasks on the finger; of the paper's size its three, safety on the flat pad as there."""
TWINS = {
    *((task, "small") for task in ("objects", "slip", "safety")),
    *((task, "paper") for _, task in DONE["paper"]),
}
"""Those that are tested on a twin too: small ones take some ten minutes of two processors more."""


@dataclass(frozen=True, kw_only=True, slots=True)
class TaskRecord:
    """One task of one design at one size."""

    design: str
    task: str
    size: str

    @property
    def twin(self) -> bool:
        """Whether a twin is photographed too."""
        return (self.task, self.size) in TWINS

    @property
    def name(self) -> str:
        """Of its file, without ending."""
        return f"{self.design}_{self.task}_{self.size}"

    @property
    def record(self) -> Record:
        """What is kept of it.

        Presses are data, as those of held-out sets are: solvers of another day do not make it
        stale; other recipes, networks, splits or scores do.
        """
        return Record(
            path=FOLDER / f"{self.name}.json",
            command=f"{COMMAND} {self.size} {self.design}_{self.task}",
            sources=("workbench.tasks",),
            apart=(
                "sim",
                "geometry",
                "designs",
                "workbench.calibration",
                "workbench.core",
                "workbench.learning.making",
                "workbench.pipeline",
                "workbench.planning",
                "workbench.project",
                "workbench.report",
                "workbench.system",
                "workbench.tasks.report",
                "workbench.view",
            ),
        )


def task_records() -> list[TaskRecord]:
    """All that may be on record, the small ones first."""
    return [
        TaskRecord(design=design, task=task, size=size)
        for size in SIZES
        for design, task in DONE[size]
    ]
