"""A search of a real, small design: cheap checks first, one press for many lights, confirmed."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from tests.photographed_pad import photographed_pad
from workbench.core.base.monitor import silent
from workbench.core.press.press import ContactSettings, Press
from workbench.project.aim import default_target_mm
from workbench.project.design_toml import design_to_toml
from workbench.project.project import Project
from workbench.search.evaluator import DesignEvaluator
from workbench.search.judged import Status
from workbench.search.loop import Budget
from workbench.search.problem import Problem
from workbench.search.problem_file import read_problem
from workbench.search.running import run_search

TEXT = """
base = "base.toml"
draft = ["case.settings.grid_mm=1.2"]
finalists = 1
[tolerances]
twins = 1
[[vary]]
field = "design.layers.elastomer_mm"
low = 2.5
high = 4.5
[[vary]]
field = "design.optics.ring.tilt_deg"
low = -80
high = 20
[[goal]]
figure = "peak_normal_force_N"
want = "max"
[[goal]]
figure = "light_on_skin_percent"
want = "max"
[[limit]]
figure = "membrane_ml"
at_most = 1.6
"""


def small_problem(
    folder: Path, text: str = TEXT, powers: tuple[float, ...] = ()
) -> tuple[Problem, Project]:
    """Quick in every setting: direct light, two frames on a coarse grid."""
    design = photographed_pad(80, 60, 50_000).replace("meshing.hex_mm", 1.0)
    design = design.replace("optics.light_model", "direct").replace("optics.ring.powers", powers)
    press = Press(target_mm=default_target_mm(design), depth_mm=0.6, frames=2)
    case = {"press": press, "settings": ContactSettings(grid_mm=1.0)}
    (folder / "base.toml").write_text(design_to_toml(design, press_case=case))
    project = Project(folder / "project")
    return read_problem(text, project, folder=folder), project


def test_fields_of_the_press_are_known_from_its_key(tmp_path: Path) -> None:
    """The wall presses anew, the tilt of LEDs does not; without a press nothing does."""
    problem, project = small_problem(tmp_path)
    assert DesignEvaluator(problem, project).of_the_press == {"design.layers.elastomer_mm"}
    light = TEXT.replace("peak_normal_force_N", "membrane_g")
    problem, project = small_problem(tmp_path, light)
    assert DesignEvaluator(problem, project).of_the_press == frozenset()


@pytest.mark.slow
def test_what_cannot_be_built_or_breaks_a_known_limit_costs_no_press(tmp_path: Path) -> None:
    """Too much silicone is known from the body, a misplaced LED too: no bake, no press."""
    problem, project = small_problem(tmp_path)
    judge = DesignEvaluator(problem, project)
    thick = judge.judge({"design.layers.elastomer_mm": 4.5}, silent)
    assert thick.status is Status.REFUSED and "membrane_ml" in thick.reason
    assert thick.skipped["press"] == thick.skipped["bake"] == 1
    assert "press" not in thick.ran and thick.figures["membrane_ml"] > 1.6
    outside = judge.judge({"design.optics.ring.radius_mm": 60.0}, silent)
    assert outside.status is Status.REFUSED and "press" not in outside.ran
    assert outside.reason


@pytest.mark.slow
def test_a_search_presses_once_for_each_wall_and_writes_its_files(tmp_path: Path) -> None:
    """Six trials in two groups: two presses beside the base's; then a finalist and its twin."""
    problem, project = small_problem(tmp_path)
    problem = dataclasses.replace(problem, limits=())
    out = tmp_path / "out"
    found = run_search(problem, project, out, Budget(trials=6))
    assert found.counted == 6
    summary = json.loads((out / "summary.json").read_text())
    assert summary["computed"]["press"] == 2 and summary["found"]["press"] == 4
    assert summary["computed"]["bake"] == 6
    # A thinner wall is stiffer: the front's end of the force has one of the thinner walls.
    best = min(found.front, key=lambda trial: trial.losses[0])
    walls = [trial.judged.parameters["design.layers.elastomer_mm"] for trial in found.trials]
    assert best.judged.parameters["design.layers.elastomer_mm"] == min(walls)
    rows = json.loads((out / "front.json").read_text())
    confirmed = [row for row in rows if "confirmed" in row]
    assert len(confirmed) == 1 and confirmed[0]["confirmed"]["holds"]
    assert confirmed[0]["worst"]["twins"] == 1
    page = (out / "report.html").read_text()
    assert "data:image/png" in page


@pytest.mark.slow
def test_solved_powers_light_the_skin_more_evenly(tmp_path: Path) -> None:
    """Six powers from one bake: far more even than a lopsided base, and the trial tells them."""
    text = TEXT.replace("peak_normal_force_N", "light_evenness_p5_over_p95_1")
    plain, project = small_problem(tmp_path, text, powers=(1.0, 0.02, 0.02, 0.02, 0.02, 0.02))
    solved = dataclasses.replace(plain, even_light=True)
    values = {"design.optics.ring.tilt_deg": -30.0}
    figures = [
        DesignEvaluator(problem, project).judge(values, silent) for problem in (plain, solved)
    ]
    name = "light_evenness_p5_over_p95_1"
    before, after = (judged.figures[name] for judged in figures)
    assert after > 1.1 * before
    assert "design.optics.ring.powers" in figures[1].parameters
