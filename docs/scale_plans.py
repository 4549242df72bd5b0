"""Plans of much work from what records hold: a million designs, the paper's samples.

A plan is what one job asks of each station, in steps. Times are measured, in the record of
`workbench bench stages` and in those of finite elements and of the paper's rates; what is assumed
stands in `ASSUMED`.
"""

from __future__ import annotations

import statistics
from collections.abc import Iterator
from dataclasses import dataclass, fields
from pathlib import Path

from workbench.cluster.simulation import WORK, Step
from workbench.learning.dataset.estimate import PAPER_SAMPLES
from workbench.proof.benchmarks.records import RoomRecord, read_record, shipped_records
from workbench.proof.validation.fem.fem_matrix import RECORD as FEM
from workbench.search.problem import Problem

KEPT = Path(__file__).parent / "scale" / "stages.json"
DESIGNS = 1_000_000
(PER_PRESS,) = (each.default for each in fields(Problem) if each.name == "per_press")
"""Trials that share a press, if a problem says nothing else."""
ASKER, SCHEDULER, DISK = "the one who asks", "Dask's scheduler", "the shared disk"
OWN, LIT = "a press of its own", "on that press"
"""Cases of the record: a design that is pressed, and one that is only lit anew."""
SHARES = {OWN: 1.0 / PER_PRESS, LIT: 1.0 - 1.0 / PER_PRESS}
TASKS_PER_S = 2000.0
DISK_MB_PER_S = 100.0
FRAMES = 32
"""Samples of a case, of which the scheduler hears once: frames of a press of `FEM`."""
PRESS = "press_300k"
"""The row of `workbench bench efficiency` that is nearest to a data set's grid."""
IMAGE = "image_640"
ASSUMED = f"""\
- Dask's scheduler takes {TASKS_PER_S:,.0f} tasks a second in a process of its own. What client and
  scheduler took together, measured, counts as the time of the one who asks too.
- The shared disk moves {DISK_MB_PER_S:g} MB a second, about what 1 Gbit/s carries; a result is
  written once, and read once by each stage that reads it.
- A worker is one thread of a processor like the measured one, which it has for itself.
- Trials come in groups of {PER_PRESS} that share a press, the default of `per_press`; none is
  refused. Of groups a mean design stands for all.
- A proposal costs what it cost after so many trials as the table says. It grows with their number
  (a Gaussian process solves a system of all of them), so a million in one study cost far more.
- The one who asks is one process, which does one thing after the other; that each call under way
  looks ten times a second whether it has ended is not counted.
- A sample is a press from rest by the contact solver (`{PRESS}` of [speed](speed.md)), a frame of
  finite elements (the finger's cases of `fem_matrix.json`) and an image (`{IMAGE}`). Presses of a
  data set go on from the frame before and cost less. It writes as much as a frame of press and
  images of the design.
- A GPU takes presses alone, one after the other, at its rate of `{PRESS}`. Side by side it takes
  more of them.
"""


@dataclass(frozen=True, kw_only=True, slots=True)
class Plan:
    """Much work of one kind; all but `jobs` is of one job."""

    what: str
    jobs: int
    """How many designs or samples."""
    steps: tuple[Step, ...]
    tasks: float
    written_MB: float
    presses: float
    """By the contact solver."""
    press_s: float
    """Time of a processor for them, which a GPU would spare it."""


def plans(record: RoomRecord) -> list[Plan]:
    """All that the page tells of."""
    proposers = sorted(values_of(record, "proposal_cpu"), reverse=True)
    return [*(designs(record, name) for name in proposers), samples(record)]


def values_of(record: RoomRecord, name: str) -> dict[str, float]:
    """Values of the rows of one name by their case."""
    return {row["case"]: row["value"] for row in record.rows if row["name"] == name}


def designs(record: RoomRecord, proposer: str) -> Plan:
    """Designs of a search: of a group the first is pressed, the others are lit.

    Args:
        record: Of `workbench bench stages`.
        proposer: A case of its row `proposal_cpu`.
    """
    judging = values_of(record, "judging_cpu")
    asks_s = values_of(record, "proposal_cpu")[proposer]
    asks_s += sum(share * judging[what] for what, share in SHARES.items())
    parts = list(_stages(record))
    tasks = sum(part.tasks for part in parts)
    (task_s,) = values_of(record, "task_cpu").values()
    asks_s += tasks * task_s
    return Plan(
        what=f"{DESIGNS:,} designs, proposed by {proposer.partition(',')[0]}",
        jobs=DESIGNS,
        steps=(
            Step(station=ASKER, seconds=asks_s),
            *(step for part in parts for step in part.steps),
        ),
        tasks=tasks,
        written_MB=sum(part.written_MB for part in parts),
        presses=SHARES[OWN],
        press_s=sum(part.press_s for part in parts),
    )


def _stages(record: RoomRecord) -> Iterator[Plan]:
    """What a mean design of a group asks of each stage."""
    spent, written, read = (
        values_of(record, f"stage_{what}") for what in ("cpu", "written", "read")
    )
    ending = f", {OWN}"
    for stage in [case.removesuffix(ending) for case in spent if case.endswith(ending)]:
        cases = {f"{stage}, {what}": share for what, share in SHARES.items()}
        known = {case: share for case, share in cases.items() if case in spent}
        tasks = sum(known.values())
        work_s = sum(share * spent[case] for case, share in known.items())
        wrote_MB = sum(share * written[case] for case, share in known.items())
        moved_MB = wrote_MB + sum(share * read[case] for case, share in known.items())
        yield Plan(
            what=stage,
            jobs=DESIGNS,
            steps=_task(tasks, work_s, moved_MB),
            tasks=tasks,
            written_MB=wrote_MB,
            presses=0.0,
            press_s=work_s if stage == "press" else 0.0,
        )


def samples(record: RoomRecord) -> Plan:
    """Samples of the paper's recipe; those of a case are one task."""
    press_s, image_s = rate_s(PRESS), rate_s(IMAGE)
    frames = values_of(record, "frames")["press"]
    written = values_of(record, "stage_written")
    wrote_MB = (written[f"press, {OWN}"] + written[f"shoot, {OWN}"]) / frames
    tasks = 1.0 / FRAMES
    return Plan(
        what=f"{PAPER_SAMPLES:,} samples of the paper's recipe",
        jobs=PAPER_SAMPLES,
        steps=_task(tasks, press_s + fem_s() + image_s, wrote_MB),
        tasks=tasks,
        written_MB=wrote_MB,
        presses=1.0,
        press_s=press_s,
    )


def processor() -> RoomRecord:
    """The paper's rates on a processor."""
    (known,) = (record for record in shipped_records() if record.kind == "cpu")
    return known


def rate_s(row: str) -> float:
    """Time of a processor for one of the paper's rates [s]."""
    return 1.0 / (processor().value(row) or float("nan"))


def fem_s() -> float:
    """Processor time of a frame of the finger by finite elements [s], by its record."""
    cases = FEM.figures()["cases"].items()
    return statistics.fmean(
        case["cpu_s"] / case["frames"] for name, case in cases if name.startswith("finger")
    )


def _task(tasks: float, work_s: float, moved_MB: float) -> tuple[Step, ...]:
    return (
        Step(station=SCHEDULER, seconds=tasks / TASKS_PER_S),
        Step(station=WORK, seconds=work_s),
        Step(station=DISK, seconds=moved_MB / DISK_MB_PER_S),
    )


def recorded() -> RoomRecord:
    """The record of `workbench bench stages` that the page is made from."""
    return read_record(KEPT)
