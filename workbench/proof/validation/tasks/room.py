"""Tasks by touch on shipped designs, each score beside null and paper.

A row passes where it beats the method without a network; one of slip must beat the time alone too,
as in renders all slides take the same steps. All images are the product's own, a
twin's too: finite elements and photons made those, the contact solver and a light field what was
learned from. So rows say what survives from one of our models to the other, not what a photograph
of a built sensor would give.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from workbench.core.base.errors import StoreError
from workbench.proof.row import Row, bounded, failed
from workbench.proof.validation.tasks.task_records import SIZES, TaskRecord, task_records
from workbench.tasks.outcome import WORDS, Trial

UNITS = {"_mm": "mm", "_MPa": "MPa", "_N": "N", "_deg": "degree"}


def rows(records: Sequence[TaskRecord] | None = None) -> list[Row]:
    """Rows of all tasks on record; of the paper's size where it was run.

    Args:
        records: None: those that ship.
    """
    found = []
    for one in task_records() if records is None else records:
        if one.size == SIZES[0] or one.record.path.exists():
            found += _rows(one)
    return found


def _rows(one: TaskRecord) -> list[Row]:
    record = one.record
    try:
        result = record.figures()["result"]
    except StoreError as error:
        return [failed(f"task_{one.task}", f"{one.design}, {one.size}", why=error.message)]
    return [_row(one, result, row) for row in result["rows"]] + _within_frames(one, result)


def _row(one: TaskRecord, result: Mapping[str, Any], row: Mapping[str, Any]) -> Row:
    details = result["details"]
    words = WORDS[Trial(row["test"])]
    test = details["tests"][row["test"]]
    tested, by_frame = test["tested_on"], test.get("told_by_frame_alone")
    null = row["null"] if by_frame is None else max(row["null"], by_frame)
    alone = "" if by_frame is None else f"; by the last frame's number alone {by_frame:.2g}"
    paper = "" if row["paper"] is None else f"; the paper's {row['paper']:g}"
    return bounded(
        f"task_{one.task}",
        f"{one.design}, {one.size}: {row['metric']} on {words}, +- {row['spread']:.2g} over "
        f"{len(tested)} seeds of {tested[0]}, by {details['network']}{alone}{paper}",
        row["value"],
        unit=_unit(row["metric"]),
        limit=null,
        sense="max" if row["metric"].startswith("mae_") else "min",
        null=null,
        record=one.record,
    )


def _within_frames(one: TaskRecord, result: Mapping[str, Any]) -> list[Row]:
    """What is told of slip where the time says nothing; none of other tasks."""
    return [
        bounded(
            f"task_{one.task}_within_frames",
            f"{one.design}, {one.size}: balanced accuracy on {WORDS[Trial(name)]}, among windows "
            f"that end in the same frame, {len(test['tested_on'])} seeds",
            test["told_within_frames"],
            unit="1",
            limit=0.5,
            sense="min",
            null=0.5,
            record=one.record,
        )
        for name, test in result["details"]["tests"].items()
        if "told_within_frames" in test
    ]


def _unit(metric: str) -> str:
    return next((unit for ending, unit in UNITS.items() if metric.endswith(ending)), "1")
