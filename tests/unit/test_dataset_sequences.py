"""Sequences for telling slip, from the shares of made samples."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from tests.unit.test_dataset_cases import flat_skin
from workbench.learning.dataset.begin import begin
from workbench.learning.dataset.cases import Case, cases_of
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.recipes import load_recipe
from workbench.learning.dataset.sample import Sample, Solved, to_bytes
from workbench.learning.dataset.sequences import FRAMES, SEQUENCES, write_sequences
from workbench.system.whole_files import write_atomically

ONSETS = {0: 12, 1: None, 2: 9, 3: 23, 4: 14}
"""First frame of gross slip of each case, from 0: one never slips."""


def made(folder: Path) -> DataSet:
    """Five cases of 24 frames, in which more and more slides until all does at the onset."""
    recipe = dataclasses.replace(load_recipe("slip"), cases=len(ONSETS))
    data = begin(folder, recipe.table, flat_skin(2.0, 1.0), cases_of(recipe))
    for number, case in enumerate(data.cases()):
        for frame in range(case.frames):
            onset = ONSETS[number]
            share = 1.0 if onset is not None and frame >= onset else 0.03 * frame
            write_atomically(data.path(case, frame), to_bytes(sample(data, case, frame, share)))
    return data


def sample(data: DataSet, case: Case, frame: int, share: float) -> Sample:
    """A frame in which this share of the contact slides."""
    count = len(data.skin.points_mm)
    solved = Solved(
        displacement_mm=np.zeros((count, 3), np.float32),
        contact_force_N=np.zeros((count, 3), np.float32),
        sliding=np.zeros(count, bool),
        sliding_share=share,
        reaction_N=np.zeros(3),
        tangential_N=0.0,
        residual=0.0,
        balance=0.0,
        converged=True,
        seconds=0.0,
    )
    return Sample(
        case=case.id,
        frame=frame,
        recipe=data.key,
        indenter=case.indenter.value,
        depth_mm=case.depth_at(frame),
        shear_mm=case.shear_at(frame),
        pose=np.array([0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0]),
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        mpm=solved,
    )


def rows(data: DataSet) -> list[dict[str, object]]:
    """The sequences that were written."""
    return [json.loads(line) for line in (data.folder / SEQUENCES).read_text().splitlines()]


def test_sequences_are_balanced_and_end_on_their_side_of_the_onset(tmp_path: Path) -> None:
    """Of each case that slips one ends before the onset and one at it or later; 8 frames each."""
    data = made(tmp_path / "set")
    assert write_sequences(data, 832) == 8
    cases = {case.id: number for number, case in enumerate(data.cases())}
    found = rows(data)
    assert sum(bool(row["slip"]) for row in found) == 4
    for row in found:
        onset, first = ONSETS[cases[str(row["case"])]], row["first"]
        assert onset is not None and isinstance(first, int) and first >= 0
        assert row["frames"] == FRAMES
        assert (first + FRAMES - 1 >= onset) is row["slip"]
        assert first + FRAMES <= 24
    assert rows(data) == found and write_sequences(data, 4) == 4
    assert rows(data) == found[:4]


def test_the_recipe_asks_for_the_papers_sequences() -> None:
    """832 of 500 slides, on the side wall only; a press of 8 frames fills the first sequence."""
    recipe = load_recipe("slip")
    cases = cases_of(recipe)
    assert recipe.sequences == 832 and len(cases) == 500
    assert {case.position.labels["polar_deg"] for case in cases} == {90.0}
    assert {(case.press_frames, case.shear_frames) for case in cases} == {(8, 16)}
    ways = [np.hypot(*case.shear_mm) for case in cases]
    assert min(ways) == pytest.approx(1.6)
