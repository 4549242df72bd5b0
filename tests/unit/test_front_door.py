"""`import workbench as wb`: what it offers, what it costs, and that it computes what is asked."""

from __future__ import annotations

import ast
import inspect
import json
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import workbench as wb
from workbench.core.design.lighting import LightModel
from workbench.core.result.force_field import Source
from workbench.report.source_files import write_sources
from workbench.system.terminal import Progress

COARSE = wb.ContactSettings(grid_mm=0.8)
BALL = wb.Indenter("sphere", size_mm=6.0)


def small(family: str) -> wb.Design:
    """A sensor whose light needs no bake, seen by a camera of 80 x 60 pixels."""
    design = wb.load(family).replace("optics.light_model", LightModel.DIRECT)
    return design.replace("optics.camera.width_px", 80).replace("optics.camera.height_px", 60)


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("door") / "project"


def test_the_three_lists_of_names_agree() -> None:
    """What is exported, where it is, and what a type checker sees."""
    tree = ast.parse(Path(inspect.getfile(wb)).read_text())
    (checked,) = (node for node in tree.body if isinstance(node, ast.If))
    typed = {
        (alias.asname or alias.name, f"{item.module}:{alias.name}")
        for item in checked.body
        if isinstance(item, ast.ImportFrom)
        for alias in item.names
    }
    places = {
        (name, place if ":" in place else f"{place}:{name}") for name, place in wb._PLACES.items()
    }
    assert typed == places
    assert sorted(wb.__all__) == sorted([*wb._PLACES, "__version__"]) == dir(wb)


@pytest.mark.parametrize("name", [name for name in wb.__all__ if name != "__version__"])
def test_every_name_is_there_and_says_what_it_is(name: str) -> None:
    """Each has a docstring of its own; a function's names all its arguments."""
    found = getattr(wb, name)
    told = inspect.getdoc(found) or ""
    assert told
    if inspect.isfunction(found):
        assert not [name for name in inspect.signature(found).parameters if name not in told]


def test_importing_costs_nothing() -> None:
    """Not even NumPy is loaded."""
    code = "import sys, workbench; print(sorted({'numpy', 'torch', 'taichi'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_an_unknown_name_is_refused() -> None:
    """As by any module, and an unknown shape with the nearest one."""
    with pytest.raises(AttributeError, match="no attribute 'pres'"):
        _ = wb.pres  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(wb.WorkbenchError, match="there is no indenter 'spher'") as caught:
        wb.Indenter("spher")  # pyright: ignore[reportArgumentType]
    assert "sphere" in caught.value.hint


def test_only_what_is_asked_for_is_computed_and_kept(project: Path) -> None:
    """The mesh needs the body alone; a second process would find the press."""
    press = wb.Press(depth_mm=0.5, frames=1)
    results = wb.evaluate(small("finger"), BALL, press, settings=COARSE, project=project)
    assert results.mesh.outer.points_mm.shape[1] == 3
    assert [outcome.stage for outcome in results.outcomes] == ["build", "mesh"]
    force_N = results.contact.reaction_N
    assert force_N.shape == (1, 3)
    assert results.images.shape == (2, 60, 80, 3)
    again = wb.evaluate(small("finger"), BALL, press, settings=COARSE, project=project)
    np.testing.assert_array_equal(again.contact.reaction_N, force_N)
    assert all(outcome.cached for outcome in again.outcomes)


def test_fields_of_the_sources_are_arrays_on_the_skin(project: Path) -> None:
    """Those of the press that is kept: forces sum up to minus the reaction; a misspelt source."""
    press = wb.Press(depth_mm=0.5, frames=1)
    results = wb.evaluate(small("finger"), BALL, press, settings=COARSE, project=project)
    arrays = results.force_arrays("mpm")
    count = len(arrays["points_mm"])
    assert arrays["mpm_displacement_mm"].shape == (1, count, 3)
    assert arrays["mpm_pressure_MPa"].shape == (1, count)
    reaction_N = arrays["mpm_reaction_N"]
    away_N = arrays["mpm_contact_force_N"].sum(axis=1, dtype=np.float64) + reaction_N
    assert np.linalg.norm(away_N) < 1e-6 * np.linalg.norm(reaction_N)
    assert arrays["mpm_peak_MPa"][0] == arrays["mpm_pressure_MPa"].max()
    # A ball of 6 mm that is pressed 0.5 mm deep touches about what the disc covers.
    assert 0.3 < arrays["mpm_peak_disc_N"][0] / np.linalg.norm(reaction_N) <= 1.0
    with pytest.raises(wb.WorkbenchError, match="no source 'fen'"):
        results.force_arrays("mpm", "fen")
    with pytest.raises(wb.WorkbenchError, match="no source of forces is named"):
        results.force_arrays()
    # A single frame straight in: nothing was in contact before it.
    assert arrays["mpm_sliding_share"].tolist() == [0.0]
    assert results.gross_slip() is None


def test_the_last_line_of_json_names_the_files_of_the_sources(
    project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every file is there; peaks of the table are those of the array file."""
    press = wb.Press(depth_mm=0.5, frames=1)
    results = wb.evaluate(small("finger"), BALL, press, settings=COARSE, project=project)
    store, printer = results.project.store, Progress(as_json=True)
    write_sources(tmp_path, (Source.MPM,), results.design, results.case, store, printer)
    last = json.loads(capsys.readouterr().out.splitlines()[-1])
    names = ["sources.csv", "sources.npz", "sources_mpm_000.vtp", "sources_mpm.pvd"]
    assert last["files"] == names
    assert sorted(names) == sorted(path.name for path in tmp_path.iterdir())
    (row,) = last["sources"]
    arrays = results.force_arrays("mpm")
    assert row["peak_disc_N"] == arrays["mpm_peak_disc_N"][-1]
    assert row["peak_MPa"] == pytest.approx(float(arrays["mpm_peak_MPa"][-1]))
    with np.load(tmp_path / "sources.npz") as file:
        assert all(np.array_equal(file[name], values) for name, values in arrays.items())
        assert set(file.files) == set(arrays)


def test_a_press_without_a_target_goes_where_the_family_is_touched(project: Path) -> None:
    """On a pad that is its middle; a chosen target stays."""
    chosen = wb.Press(target_mm=(2.0, 1.0, 23.0))
    assert wb.evaluate(small("pad"), BALL, chosen, project=project).case.press is chosen
    aimed = wb.evaluate(small("pad"), BALL, project=project)
    np.testing.assert_allclose(aimed.case.press.target_mm[:2], (0.0, 0.0), atol=1e-9)


def test_what_does_not_fit_is_refused_before_anything_is_pressed(project: Path) -> None:
    """Deeper than the wall; and names of stages and sources that do not exist."""
    with pytest.raises(wb.WorkbenchError, match="mm"):
        wb.evaluate(small("finger"), BALL, wb.Press(depth_mm=30.0), project=project)
    results = wb.evaluate(small("finger"), BALL, project=project)
    with pytest.raises(wb.WorkbenchError, match="no stage 'mes'"):
        _ = results["mes"]
    with pytest.raises(wb.WorkbenchError, match="no source 'ansys'"):
        results.forces("ansys")


def test_a_sweep_and_a_comparison(project: Path) -> None:
    """Twice the depth: more than twice the force, and told so for B."""
    press = wb.Press(depth_mm=0.4, frames=1)
    base = wb.evaluate(small("finger"), BALL, press, settings=COARSE, project=project)
    found = wb.sweep(base, "press.depth_mm", 0.4, 0.8, steps=2)
    shallow, deep = (point.figures for point in found.points)
    assert [point.value for point in found.points] == [0.4, 0.8]
    assert deep["press_depth_mm"] == 2 * shallow["press_depth_mm"]
    deeper = wb.Press(depth_mm=0.8, frames=1)
    other = wb.evaluate(small("finger"), BALL, deeper, settings=COARSE, project=project)
    changes = {change.rule.name: change for change in wb.compare(base, other, ("shoot",))}
    assert changes["press_depth_mm"].percent == pytest.approx(100.0)
    assert other.contact.reaction_N[-1] @ other.contact.normal > 2 * (
        base.contact.reaction_N[-1] @ base.contact.normal
    )
