"""`workbench sweep` from its arguments to its files, with stages that a store answers."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest

from tests.unit.test_sweeps import shot
from workbench.cli import main
from workbench.named_designs import load_design
from workbench.pipeline import plan
from workbench.project import Project
from workbench.state import fresh_state
from workbench.sweep_fields import find_field, with_value

WALL = "design.layers.elastomer_mm"


def store_point(project: Project, wall_mm: float) -> None:
    """The image of a point, as its stages would leave it."""
    state = fresh_state(load_design("finger"))
    state = with_value(state, find_field(state, WALL), wall_mm)
    key = plan(state.design, state.case)["shoot"].key
    project.store.save("shoot", key, shot(10.0 * wall_mm), seconds=1.0, version=1)


def test_a_sweep_writes_plot_data_and_report(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Any
) -> None:
    """Walls of 1 and 2 mm, whose images are stored: figures in JSON and CSV, a plot in HTML."""
    monkeypatch.setattr("workbench.sweep_command.evaluate", lambda *a, **k: iter(()))
    project = Project(tmp_path / "project")
    store_point(project, 1.0)
    store_point(project, 2.0)
    out = tmp_path / "out"
    words = ["sweep", "finger", "--field", "layers.elastomer_mm", "--from", "1", "--to", "2"]
    words += ["--steps", "2", "--out", str(out), "--project", str(project.folder), "--json"]
    assert main(words) == 0
    told = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert told == json.loads((out / "sweep.json").read_text())
    assert [point["status"] for point in told["points"]] == ["done", "done"]
    grey = [point["figures"]["contact_change_mean_grey"] for point in told["points"]]
    assert grey == [10.0, 20.0]
    rows = list(csv.reader((out / "sweep.csv").open()))
    assert rows[0][:2] == ["elastomer_mm", "status"] and rows[1][0] == "1.0"
    assert "<svg" in (out / "sweep.html").read_text()


@pytest.mark.parametrize(
    "words",
    [
        ("--field", "layers.elastomer", "--from", "1", "--to", "2"),
        ("--field", WALL, "--from", "1", "--to", "1"),
        ("--field", WALL, "--from", "1", "--to", "2", "--steps", "99"),
        ("--field", WALL, "--from", "-3", "--to", "-1"),
        ("--field", WALL, "--from", "1", "--to", "2", "--metric", "beauty"),
    ],
)
def test_bad_sweeps_are_refused_before_anything_is_written(
    tmp_path: Path, words: tuple[str, ...]
) -> None:
    """Exit code 2 and no folder."""
    out = tmp_path / "out"
    line = ["sweep", "finger", *words, "--out", str(out), "--project", str(tmp_path / "p")]
    assert main(line) == 2
    assert not out.exists()
