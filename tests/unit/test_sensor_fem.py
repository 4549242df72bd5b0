"""Fast contact beside finite elements: what the rows say of figures that are made up."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from workbench.proof.row import Row
from workbench.proof.validation.sensor.fem_presses import PRESSED
from workbench.proof.validation.sensor.fem_rows import rows
from workbench.system.record import Record

OURS = {
    "depth_mm": [0.3, 0.6, 1.0],
    "normal_N": [1.05, 2.1, 4.6, 4.0, 4.0, 4.0],
    "full_normal_N": [1.0, 1.9, 4.0, 4.0, 4.0, 4.0],
    "across_N": [0.0, 0.0, 0.0, 0.6, 1.1, 1.8],
    "slip": [0.0, 0.0, 0.1, 0.2, 0.3, 0.5],
    "full_slip": [0.0, 0.0, 0.3, 0.2, 0.3, 0.5],
}
TRUTH = {
    "pressed": list(PRESSED),
    "normal_N": [1.0, 2.0, 4.0, 4.0, 4.0, 4.0],
    "across_N": [0.0, 0.0, 0.0, 0.5, 1.0, 2.0],
    "slip": [0.0, 0.0, 0.0, 0.2, 0.3, 0.4],
    "error": [0.05, -0.02, 0.01, 0.01, 0.01, 0.01],
}


def record(path: Path, figures: dict[str, object]) -> Record:
    """A record of figures that rest on no code here."""
    kept = Record(path=path, command="none", sources=("elsewhere",))
    path.write_text(json.dumps({"code": "some", "made": "today", "designs": figures}))
    return kept


@pytest.fixture
def found(tmp_path: Path) -> dict[str, list[Row]]:
    """Rows by their names."""
    unsure = {**TRUTH, "error": []}
    deeper = {**TRUTH, "pressed": [6.0, 2.0, 10, 0.5]}
    presses = {"pad": {"cube": TRUTH, "flower": unsure, "ring": deeper}, "paw": {"cube": TRUTH}}
    truth = record(tmp_path / "fem.json", presses)
    ours = record(
        tmp_path / "fast.json", {"pad": {"fit": {}, "cube": OURS, "flower": OURS, "ring": OURS}}
    )
    sorted_rows: dict[str, list[Row]] = {}
    for row in rows(truth, ours):
        sorted_rows.setdefault(row.name, []).append(row)
    return sorted_rows


def test_errors_are_of_finite_elements(found: dict[str, list[Row]]) -> None:
    """Force by force, the elements' own error as ceiling where they know it; a press that only one
    has, or pressed otherwise, fails."""
    forces = [row for row in found["fast_fem_force"] if row.value is not None]
    assert [row.value for row in forces] == pytest.approx([0.05, 0.05, 0.15] * 2)
    assert [row.ceiling for row in forces] == [0.05, 0.02, 0.01, None, None, None]
    assert [row.limit for row in forces] == [0.1, 0.1, 0.1, None, None, None]
    assert [row.ok for row in forces] == [True, True, False, True, True, True]
    solver = found["fast_fem_mpm_force"]
    assert [row.value for row in solver] == pytest.approx([0.05, 0.05])
    assert found["fast_fem_shear"][0].value == pytest.approx(0.2 / 2.0)


def test_presses_that_cannot_be_compared_fail(found: dict[str, list[Row]]) -> None:
    """One was solved for another depth, one fast contact has not played."""
    lost = [row for row in found["fast_fem_force"] if row.value is None]
    assert [row.ok for row in lost] == [False, False]
    assert "pad, ring" in lost[0].case and "paw, cube" in lost[1].case


def test_shares_that_slide_are_compared_straight_and_sheared(
    found: dict[str, list[Row]],
) -> None:
    """The contact solver's beside: it may be the one that is off."""
    assert found["fast_fem_slip"][0].value == pytest.approx(0.1)
    assert found["fast_fem_mpm_slip"][0].value == pytest.approx(0.3)
    assert found["fast_fem_slip_sheared"][0].value == pytest.approx(0.1)


def test_a_record_that_is_not_there_is_a_failed_row(tmp_path: Path) -> None:
    """One for all."""
    gone = Record(path=tmp_path / "none.json", command="make it", sources=("elsewhere",))
    (row,) = rows(gone, gone)
    assert not row.ok and "cannot be read" in row.case
