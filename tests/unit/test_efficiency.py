"""The table of frame rates: a row for each, the paper's own figures beside ours."""

from __future__ import annotations

import numpy as np
import pytest

from docs.generate_speed import page
from sim.contact.solver import reactions
from sim.contact.solver.run import Run, relaxation_of
from workbench.core.base.errors import SolveError
from workbench.pipeline import devices
from workbench.proof.benchmarks import contact, efficiency, forces, optics
from workbench.proof.benchmarks.paces import ALL, PUBLISHED, published_fps
from workbench.proof.benchmarks.records import shipped_records


def measured(name: str, least_fps: float = 0.0) -> forces.Measured:
    """A rate that nobody measured."""
    return forces.Measured(name=name, case="a case", fps=7.0, least_fps=least_fps)


def test_every_rate_of_the_table_has_its_row(monkeypatch: pytest.MonkeyPatch) -> None:
    """In its order; what the paper reports is the reference, settled presses have none."""
    monkeypatch.setattr(devices, "open_device", lambda: "cpu")
    monkeypatch.setattr(contact, "whole_finger", lambda grid_mm: (None, 5))
    monkeypatch.setattr(contact, "substep_s", lambda engine: 0.5)
    monkeypatch.setattr(efficiency, "settled_per_s", lambda grid_mm: 3.0)
    monkeypatch.setattr(optics, "video_fps", lambda model, width_px: 4.0)
    sizes = [name for name, _, _ in forces.SIZES]
    monkeypatch.setattr(forces, "paces", lambda network: map(measured, sizes))
    monkeypatch.setattr(forces, "patch_pace", lambda: measured(sizes[-1]))
    rows = efficiency.rows()
    assert [row.name for row in rows] == [pace.row for pace in ALL]
    assert [row.reference for row in rows] == [pace.fps for pace in ALL]
    assert [row.value for row in rows] == [2.0] * 3 + [3.0] * 3 + [4.0] * 3 + [7.0] * 4
    assert [published_fps(pace.row) for pace in PUBLISHED][:3] == [250.0, 33.0, 10.0]
    assert published_fps("press_40k") is None


class Unsettled:
    """A press that ends without balance."""

    reaction_N = np.full((1, 3), np.nan)

    def __init__(self, problems: list[object]) -> None:
        assert len(problems) == 1

    def run(self) -> None:
        """At once."""


def test_a_press_that_does_not_settle_has_no_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    """However fast it ended."""
    monkeypatch.setattr(contact, "whole_problem", lambda grid_mm: None)
    monkeypatch.setattr(reactions, "Reactions", Unsettled)
    with pytest.raises(SolveError, match=r"grid of 0\.6 mm did not settle"):
        efficiency.settled_per_s(0.6)
    monkeypatch.setattr(Unsettled, "reaction_N", np.ones((1, 3)))
    assert efficiency.settled_per_s(0.6) > 0.0


@pytest.mark.usefixtures("taichi_device")
def test_batches_are_of_presses_that_can_be_made() -> None:
    """In one piece is without friction: what rubs rests each 0.1 mm."""
    for friction, rests in ((0.0, 1), (0.3, 10)):
        problem = contact._problem(0, friction)
        assert problem.material.friction == friction
        run = Run(problem, relaxation_of([problem]), 0)
        run.begin()
        assert run.increments == rests


def test_patches_are_held_to_their_rate_on_a_gpu_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """299 of 300 a second fail there, elsewhere the rate is stated."""
    for fps, least_fps, good in ((299.0, 300.0, False), (301.0, 300.0, True), (1.0, 0.0, True)):
        found = forces.Measured(name="25k", case="a case", fps=fps, least_fps=least_fps)
        monkeypatch.setattr(forces, "patch_pace", lambda found=found: found)
        row = forces.patch_row()
        assert row.ok is good and row.limit == (least_fps or None)


def test_the_page_of_speed_has_all_that_records_hold() -> None:
    """A line for each rate, a column for each record, and the case of each row."""
    text, known = page(), shipped_records()
    for pace in ALL:
        assert f"| {pace.what}, {pace.size} | {pace.meaning} |" in text
    for record in known:
        assert text.count(record.title) == 2
        assert all(f"`{row['name']}`: {row['case']}" in text for row in record.rows)
