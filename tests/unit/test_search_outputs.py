"""The files of a search, read back: front, designs, table, report; and its finalists' twins."""

from __future__ import annotations

import csv
import io
import json
import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from tests.toy_search import LIMIT, F, G, Toy, X, Y, toy_problem
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.search.finalists import Finalist, finalists, twin_of, worst_figures
from workbench.search.front import Found, found_of
from workbench.search.front_plot import front_svg, lines_svg
from workbench.search.journal import FILE
from workbench.search.judged import savings
from workbench.search.kept_searches import (
    Asked,
    design_of,
    kept_problem,
    list_searches,
    new_search,
    search_folder,
    standing,
)
from workbench.search.loop import Budget, search
from workbench.search.outputs import trials_csv, write_front
from workbench.search.parallel_plot import parallel_svg
from workbench.search.problem import Goal, Problem, Tolerances, Vary, Want
from workbench.search.report import gains, report_page

pytest.importorskip("optuna")


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Project, Found, list[Finalist]]:
    """Nine trials, some of them refused, and their files."""
    folder = tmp_path_factory.mktemp("search")
    project, problem = Project(folder / "project"), toy_problem(folder, LIMIT)
    study = search(problem, Toy(refused_above=1.3), folder / FILE, Budget(trials=9))
    found = found_of(problem, study)
    listed = finalists(found, project, confirm=False)
    write_front(folder, found, listed, project)
    page = report_page(found, listed, {F: {X: 0.7, Y: 0.3}}, project.store)
    (folder / "report.html").write_text(page)
    return folder, project, found, listed


def test_each_design_of_the_front_opens_with_its_parameters(made) -> None:
    """`front.json` names the files, whose fields are the parameters it tells."""
    folder, project, found, _ = made
    rows = json.loads((folder / "front.json").read_text())
    assert len(rows) == len(found.front) > 0
    for row in rows:
        assert {"name", "design", "figures", "parameters"} <= set(row)
        design = load_design(folder / row["design"])
        assert design.optics.coating.albedo == row["parameters"][X]
        assert design.optics.coating.specular == row["parameters"][Y]
        assert design_of(project, folder, row).design == design
    assert [row["figures"][F] for row in rows] == sorted(row["figures"][F] for row in rows)


def test_the_table_has_every_trial(made) -> None:
    """A row each, refused ones with their reason, numbers as they were."""
    _, _, found, _ = made
    rows = list(csv.DictReader(io.StringIO(trials_csv(found))))
    assert [int(row["trial"]) for row in rows] == [trial.number for trial in found.trials]
    for row, trial in zip(rows, found.trials, strict=True):
        assert float(row[X]) == trial.judged.parameters[X]
        assert row["status"] == trial.judged.status.value
        assert (row[F] == "") == (not trial.judged.figures)
    assert any(row["reason"] == "beyond the line" for row in rows)


def test_the_report_is_one_file_that_loads_nothing(made) -> None:
    """No address, no file beside it; plots are sound XML, and lines carry the trials' numbers."""
    folder, _, found, _ = made
    text = (folder / "report.html").read_text()
    assert not re.search(r"(src|href)=['\"]?(https?:|//|\w+/)", text)
    assert "beyond the line" in text
    for svg in re.findall(r"<svg.*?</svg>", text, re.DOTALL):
        ElementTree.fromstring(svg)
    lines = re.findall(r"<polyline data-trial='(\d+)' data-at='([^']+)'", text)
    judged = {trial.number for trial in found.trials if trial.losses}
    assert {int(number) for number, _ in lines} == judged
    # Two fields and two goals: a height for each.
    assert all(len(at.split()) == 4 for _, at in lines)
    assert "70 %" in text


def test_plots_of_a_search_without_a_trial_say_so(tmp_path: Path) -> None:
    """And of one goal the trials stand in their order."""
    problem = toy_problem(tmp_path)
    empty = Found(problem=problem, trials=(), front=(), base=None)
    assert "No trial" in front_svg(empty) and parallel_svg(empty) == "" and "No" in lines_svg({})
    assert gains(empty) == []


def test_gains_are_those_over_the_base(made) -> None:
    """The base has f = 1.25: the best f of the front is told beside it."""
    _, _, found, _ = made
    best = min(trial.judged.figures[F] for trial in found.front)
    (first, *_) = gains(found)
    assert "base 1.25" in first and f"best {best:.4g}" in first


def test_worst_figures_are_by_the_way_of_each_goal(tmp_path: Path) -> None:
    """F is to be small: the largest; of a limit from below the smallest."""
    problem = toy_problem(tmp_path, LIMIT)
    rows = [
        {F: 1.0, G: 2.0, "skin_seen_percent": 50.0},
        {F: 3.0, G: 1.0, "skin_seen_percent": 20.0},
    ]
    assert worst_figures(problem, rows) == {F: 3.0, G: 2.0, "skin_seen_percent": 20.0}


def test_twins_stay_within_what_a_workshop_is_off_by(tmp_path: Path) -> None:
    """Each amount is reached by half and never left; a number always has the same twin."""
    base = toy_problem(tmp_path).base
    told = Tolerances(twins=40, led_mm=0.3, wall_mm=0.15, young_percent=20.0)
    twins = [twin_of(base, told, 1, number).design for number in range(40)]
    design = base.design
    off = {
        0.3: [twin.optics.ring.radius_mm - design.optics.ring.radius_mm for twin in twins],
        0.15: [twin.layers.elastomer_mm - design.layers.elastomer_mm for twin in twins],
        0.2: [twin.material.young_MPa / design.material.young_MPa - 1.0 for twin in twins],
    }
    for amount, values in off.items():
        assert 0.5 * amount < np.abs(values).max() <= amount + 1e-9
    assert all(twin.optics.camera.position_mm == design.optics.camera.position_mm for twin in twins)
    assert twin_of(base, told, 1, 7) == twin_of(base, told, 1, 7)
    assert twin_of(base, told, 1, 7) != twin_of(base, told, 2, 7)


def test_a_form_is_kept_as_the_file_of_a_command(tmp_path: Path) -> None:
    """What a form asks is read back as a problem of the design that stood."""
    project = Project(tmp_path)
    state = toy_problem(tmp_path).base
    asked = Asked(
        vary=(
            Vary(path=X, title="", low=0.1, high=0.9),
            Vary(path="design.optics.ring.mount", title="", choices=("cavity", "shell")),
        ),
        goals=(Goal(figure=F, want=Want.TARGET, value=5.0),),
        wishes=("robust to .3 mm",),
    )
    folder = new_search(project, "geltip 1", state, asked)
    assert folder == search_folder(project, "geltip 1")
    assert list_searches(project) == ["geltip 1"]
    problem: Problem = kept_problem(project, "geltip 1")
    assert problem.base == state
    assert problem.goals == asked.goals and problem.tolerances.twins == 8
    assert (problem.vary[0].low, problem.vary[0].high) == (0.1, 0.9)
    assert problem.vary[1].choices == ("cavity", "shell")
    assert standing(folder).summary == {}


def test_savings_are_counted(made) -> None:
    """What ran, what was found, what was spared, added up."""
    trials = [trial.judged for trial in made[2].trials]
    assert savings(trials).words == ""
    from workbench.search.judged import Judged, Status

    one = Judged(status=Status.JUDGED, ran={"press": 1, "bake": 1}, found={"build": 1})
    two = Judged(status=Status.REFUSED, found={"bake": 1}, skipped={"press": 1})
    words = savings([one, two]).words
    assert "presses: 1 computed, 0 found, 1 spared" in words
    assert "bakes: 1 computed, 1 found, 0 spared" in words
