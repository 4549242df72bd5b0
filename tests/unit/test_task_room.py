"""The room of tasks: recorded scores beside their null, stale once the code is another."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from workbench.core.base.errors import DesignError
from workbench.proof.judge import judge
from workbench.proof.validation.tasks import room, task_records
from workbench.proof.validation.tasks.task_figures import wanted
from workbench.proof.validation.tasks.task_records import TaskRecord

ONE = TaskRecord(design="geltip", task="safety", size="small")


def result(value: float) -> dict[str, Any]:
    """What a task leaves."""
    row = {"task": "safety", "test": "sim", "metric": "mae_peak_MPa", "value": value}
    details = {"network": "lite", "tests": {"sim": {"tested_on": [34, 34, 34]}}}
    return {
        "result": {
            "rows": [{**row, "spread": 0.01, "null": 0.07, "paper": 0.028}],
            "details": details,
        }
    }


@pytest.fixture
def kept(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Records go to a folder of the test's."""
    monkeypatch.setattr(task_records, "FOLDER", tmp_path)
    return tmp_path


def test_a_row_is_met_where_it_beats_its_null(kept: Path) -> None:
    """.05 of .07 is met, .08 is not; the paper's stands in the case."""
    for value, good in ((0.05, True), (0.08, False)):
        ONE.record.make(lambda value=value: result(value))
        (row,) = room.rows([ONE])
        assert (row.value, row.null, row.unit, row.ok) == (value, 0.07, "MPa", good)
        assert "the paper's 0.028" in row.case and "3 seeds of 34" in row.case
        assert judge(row.name, row.case).value == "itself"


def test_a_record_of_other_code_is_stale(kept: Path) -> None:
    """And none at all is no row that is met."""
    (row,) = room.rows([ONE])
    assert not row.ok and "there is none" in row.case
    ONE.record.make(lambda: result(0.05))
    path = kept / "geltip_safety_small.json"
    path.write_text(json.dumps({**json.loads(path.read_text()), "code": "another"}))
    (row,) = room.rows([ONE])
    assert row.stale and not row.ok
    assert "task_figures FOLDER small geltip_safety" in row.case


def test_records_are_asked_for_by_size_and_name() -> None:
    """All of a size, or one; another is refused."""
    assert len(wanted(["paper"])) == len(task_records.DONE["paper"])
    assert [one.name for one in wanted(["paper", "pad_safety"])] == ["pad_safety_paper"]
    with pytest.raises(DesignError, match="no task 'paw_slip_small' is on record"):
        wanted(["small", "paw_slip"])


def test_slip_must_beat_the_time_alone(kept: Path) -> None:
    """.83 against a motion of .5 and a frame's number of .85 is not met."""
    row = {"task": "slip", "test": "sim", "metric": "balanced_accuracy", "value": 0.83}
    alone, within = {"told_by_frame_alone": 0.85}, {"told_within_frames": 0.7}
    test = {"tested_on": [80, 80, 80], **alone, **within}
    found = {
        "rows": [{**row, "spread": 0.1, "null": 0.5, "paper": None}],
        "details": {"network": "motion", "tests": {"sim": test}},
    }
    one = TaskRecord(design="geltip", task="slip", size="small")
    one.record.make(lambda: {"result": found})
    slip, within_frames = room.rows([one])
    assert (slip.null, slip.ok) == (0.85, False) and "number alone 0.85" in slip.case
    assert (within_frames.value, within_frames.null, within_frames.ok) == (0.7, 0.5, True)
    assert judge(within_frames.name, within_frames.case).value == "itself"
