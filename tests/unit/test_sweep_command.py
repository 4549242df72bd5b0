"""`workbench sweep` from its arguments to its files, with stages that a store answers."""

from __future__ import annotations

import csv
import dataclasses
import json
from pathlib import Path
from typing import Any

import pytest

from tests.unit.test_sweeps import shot
from workbench.cli.command_line import main, parser
from workbench.cli.held_state import base_state
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.edit.strokes import read_stroke
from workbench.planning.plan import plan
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.state import State, fresh_state
from workbench.system.terminal import Progress
from workbench.variants.sweep_fields import find_field, with_value
from workbench.variants.variants import save_variant

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
    monkeypatch.setattr("workbench.variants.sweep_computing.evaluate", lambda *a, **k: iter(()))
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


def case_of(project: Project, *words: str) -> PressCase:
    """The press of a sweep with these options, before anything is computed."""
    line = [*words, "--field", WALL, "--from", "1", "--to", "2", "--out", "x"]
    options = parser().parse_args(["sweep", *line])
    return base_state(options, project, Progress(as_json=True)).case


def test_a_sweep_takes_the_press_of_run(tmp_path: Path) -> None:
    """Object, place, path and solver as typed; what is left out as in `run`."""
    words = "--indenter cube --size-mm 4 --target 0,9,36 --depth-mm 0.7 --shear-mm 0.5,0"
    case = case_of(
        Project(tmp_path), "finger", *words.split(), "--twist-deg", "5", "--penalty", "60"
    )
    assert (case.indenter.kind, case.indenter.size_mm) == (IndenterKind.CUBE, 4.0)
    assert case.press == Press(
        target_mm=(0.0, 9.0, 36.0), depth_mm=0.7, shear_mm=(0.5, 0.0), twist_deg=5.0
    )
    assert case.settings == ContactSettings(penalty=60.0)


def test_options_change_what_a_variant_holds_and_leave_the_rest(tmp_path: Path) -> None:
    """A cube of 4 mm at (0, 9, 36) with a stroke: larger and deeper, all else as it was kept."""
    project = Project(tmp_path)
    strokes = (read_stroke("hold:2", frames=3),)
    press = Press(target_mm=(0.0, 9.0, 36.0), frames=3, strokes=strokes)
    cube = Indenter(kind=IndenterKind.CUBE, size_mm=4.0, edge_radius_mm=0.3)
    settings = ContactSettings(grid_mm=0.8)
    held = PressCase(indenter=cube, press=press, settings=settings)
    save_variant(project, "kept", State(design=load_design("finger"), case=held))
    path = str(project.folder / "variants" / "kept.toml")
    assert case_of(project, path) == held
    case = case_of(project, path, "--size-mm", "5", "--depth-mm", "0.5")
    assert case.indenter == dataclasses.replace(cube, size_mm=5.0)
    assert case.press == dataclasses.replace(press, depth_mm=0.5)
    assert case.settings == settings


def test_a_kept_trajectory_takes_no_depth(tmp_path: Path) -> None:
    """`--depth-mm` would change nothing of timed poses: it is refused, with the way out."""
    project = Project(tmp_path / "project")
    rows = tmp_path / "path.csv"
    rows.write_text("t_s,x_mm,y_mm,z_mm,qw,qx,qy,qz\n0,0,0,60,1,0,0,0\n1,0,0,58,1,0,0,0\n")
    timed = case_of(project, "finger", "--trajectory", str(rows))
    save_variant(project, "timed", State(design=load_design("finger"), case=timed))
    path = str(project.folder / "variants" / "timed.toml")
    assert case_of(project, path) == timed
    with pytest.raises(DesignError, match="the trajectory of the design file") as caught:
        case_of(project, path, "--depth-mm", "0.5")
    assert caught.value.at == "--depth-mm"
    assert caught.value.hint == "leave --depth-mm out"
