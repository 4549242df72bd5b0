"""Data sets made from end to end: solved, stopped, killed, gone on with, and failing."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workbench.cli.command_line import main
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.recipes import load_recipe, recipe_to_toml

pytestmark = pytest.mark.slow
ROOT = Path(__file__).parents[2]
LONG_S = 120.0


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project whose store keeps mesh and material points from test to test."""
    return tmp_path_factory.mktemp("project")


def words(project: Path, out: Path, *more: str, recipe: str = "tiny") -> list[str]:
    """The command line that makes a data set."""
    return ["dataset", "make", recipe, "--out", str(out), "--project", str(project), *more]


def begun(project: Path, out: Path, *more: str) -> subprocess.Popen[bytes]:
    """Make a data set in a process of its own; returns once it has a sample."""
    code = "import sys; from workbench.cli import main; sys.exit(main(sys.argv[1:]))"
    line = [sys.executable, "-c", code, *words(project, out, *more)]
    process = subprocess.Popen(line, cwd=ROOT, start_new_session=True)
    until = time.monotonic() + LONG_S
    while not list(out.glob("cases/*/*.npz")):
        assert process.poll() is None and time.monotonic() < until
        time.sleep(0.02)
    return process


def answer(capsys: pytest.CaptureFixture[str], *words: str) -> Any:
    """The last line of JSON that a command prints."""
    main(["dataset", *words, "--json"])
    return json.loads(capsys.readouterr().out.splitlines()[-1])


def stamps(out: Path) -> dict[str, int]:
    """When each sample was written."""
    return {str(p.relative_to(out)): p.stat().st_mtime_ns for p in out.glob("cases/*/*.npz")}


def test_both_solvers_press_the_same_skin_on_the_same_path(
    project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Reaction = minus the sum of nodal forces, in both; images darken or light where it dents."""
    out = tmp_path / "set"
    text = recipe_to_toml(load_recipe("tiny")).replace("images = false", "images = true")
    file = tmp_path / "recipe.toml"
    file.write_text(text)
    assert main(words(project, out, "--cases", "1", recipe=str(file))) == 0
    data = DataSet.open(out)
    (case,) = data.cases()
    assert data.frames(case) == [0, 1]
    first, last = (data.sample(case, frame) for frame in (0, 1))
    for sample in (first, last):
        assert sample.mpm is not None and sample.fem is not None
        for found, least in ((sample.mpm, 1e-5), (sample.fem, 1e-5)):
            total_N = found.contact_force_N.sum(axis=0, dtype=np.float64)
            # Nodal forces are kept in single precision.
            assert np.allclose(found.reaction_N, -total_N, atol=least)
            assert found.reaction_N @ sample.normal > 0.0
        assert sample.fem.converged and sample.fem.residual <= 1e-6
        assert len(sample.fem.cauchy_MPa) == len(data.skin.points_mm)
        assert np.isclose(np.linalg.norm(sample.pose[3:]), 1.0)
    assert np.isclose((first.pose - last.pose)[:3] @ first.normal, 0.1, atol=1e-6)
    assert first.fem is not None and last.fem is not None and last.mpm is not None
    least, most = (sample.fem.peaks(data.skin) for sample in (first, last))
    assert most.peak_MPa > least.peak_MPa and most.peak_disc_N > least.peak_disc_N > 0.0
    # The draft mesh is too stiff by some ten percent, more at .2 mm: both solvers agree to half.
    ratio = (last.mpm.reaction_N @ last.normal) / (last.fem.reaction_N @ last.normal)
    assert 0.5 < ratio < 1.5
    rest = np.asarray(last.image, float) - np.asarray(first.image, float)
    assert np.abs(rest).max() > 0.0
    assert np.abs(np.asarray(last.image, float) - last.image_markers).max() > 50.0
    capsys.readouterr()
    counts = answer(capsys, "status", str(out))
    assert (counts["samples_done"], counts["cases_done"]) == (2, 1)
    assert answer(capsys, "preview", str(out))["file"] == str(out / "preview.png")
    cost = answer(capsys, "make", str(file), "--out", str(out), "--estimate")
    assert cost["samples_left"] == 2 and cost["core_hours_left"] > 0.0


def test_an_estimate_of_nothing_times_cases_and_throws_them_away(
    project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """One of two cases is timed, by both solvers; all four samples are left, no folder is made."""
    out = tmp_path / "set"
    cost = answer(capsys, *words(project, out)[1:], "--estimate")
    assert (cost["cases"], cost["samples"], cost["samples_left"]) == (2, 4, 4)
    assert (cost["cases_timed"], cost["samples_timed"]) == (1, 2)
    for solver in ("mpm", "fem"):
        assert 0.0 < cost[f"{solver}_s_per_sample"] < cost["seconds_per_sample"]
    assert cost["core_hours_left"] == pytest.approx(4 * cost["cpu_s_per_sample"] / 3600.0)
    assert not out.exists()


def test_presses_side_by_side_are_what_they_are_alone(project: Path, tmp_path: Path) -> None:
    """The same bits; and a gel k times as stiff gives k times the force of the recipe's own."""
    own = recipe_to_toml(load_recipe("tiny")).replace('solvers = "both"', 'solvers = "mpm"')
    drawn = own + "\n[vary]\nyoung_MPa = [0.1, 0.2]\n"
    sets = []
    for name, text, batch in (("own", own, "2"), ("alone", drawn, "1"), ("together", drawn, "2")):
        file = tmp_path / f"{name}.toml"
        file.write_text(text)
        out = tmp_path / name
        assert main(words(project, out, "--batch", batch, recipe=str(file))) == 0
        sets.append(DataSet.open(out))
    for cases in zip(*(data.cases() for data in sets), strict=True):
        found = [data.sample(case, 1).mpm for data, case in zip(sets, cases, strict=True)]
        plain, alone, together = found
        assert plain is not None and alone is not None and together is not None
        assert np.array_equal(alone.displacement_mm, together.displacement_mm)
        assert np.array_equal(alone.contact_force_N, together.contact_force_N)
        assert cases[1].drawn.young_MPa is not None
        material = sets[0].manifest["recipe"]["design"]["material"]
        stiffer = cases[1].drawn.young_MPa / material["young_MPa"]
        off_N = np.linalg.norm(alone.reaction_N - stiffer * plain.reaction_N)
        # A frame has settled when the forces on free nodes sum to less than .5 % of the load.
        assert off_N <= 5e-3 * np.linalg.norm(alone.reaction_N)


def test_a_killed_make_goes_on_where_it_was(project: Path, tmp_path: Path) -> None:
    """SIGKILL leaves samples, a dead lock and no orphans; the next make keeps what is done."""
    out = tmp_path / "set"
    process = begun(project, out, "--solver", "fem")
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    before = stamps(out)
    until = time.monotonic() + 10.0
    while _group_lives(process.pid) and time.monotonic() < until:
        time.sleep(0.05)
    assert not _group_lives(process.pid)
    before |= stamps(out)
    assert main(words(project, out, "--solver", "fem")) == 0
    after = stamps(out)
    assert len(after) == 4
    assert {name: after[name] for name in before} == before
    assert len(list(DataSet.open(out).samples())) == 4
    # Nothing is left to do, so nothing is touched.
    assert main(words(project, out, "--solver", "fem")) == 0
    assert stamps(out) == after


def _group_lives(pid: int) -> bool:
    try:
        os.killpg(pid, 0)
    except ProcessLookupError:
        return False
    return True


def test_an_interrupt_stops_cleanly(
    project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """SIGINT ends with 130, the lock gone, the manifest counted, and samples readable."""
    out = tmp_path / "set"
    process = begun(project, out, "--solver", "mpm", "--cases", "30")
    second = answer(capsys, *words(project, out, "--solver", "mpm", "--cases", "30")[1:])
    assert "is making the data set" in second["message"]
    os.killpg(process.pid, signal.SIGINT)
    assert process.wait(timeout=LONG_S) == 130
    assert not (out / "lock").exists()
    data = DataSet.open(out)
    done = len(list(data.samples()))
    assert 0 < done < data.manifest["counts"]["samples"] == 60
    assert data.manifest["counts"]["samples_done"] == done
    assert not data.failed()


def test_a_failing_case_does_not_stop_the_rest(
    project: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """2.4 mm into a 2 mm wall: refused with the reason, counted, told by the exit status, and not
    tried again until it is repaired."""
    file, out = tmp_path / "deep.toml", tmp_path / "set"
    text = recipe_to_toml(load_recipe("tiny"))
    text = text.replace("depth_mm = 0.2", "depth_mm = 2.4")
    file.write_text(text.replace("depth_step_mm = 0.1", "depth_step_mm = 1.2"))
    assert main(words(project, out, recipe=str(file))) == 3
    data = DataSet.open(out)
    assert set(data.failed()) == {case.id for case in data.cases()}
    assert all("support" in row["message"] for row in data.failed().values())
    assert data.manifest["counts"]["cases_failed"] == 2
    assert "2 failed" in (out / "card.md").read_text()
    rows = (out / "failed.jsonl").read_text()
    assert main(words(project, out, recipe=str(file))) == 3
    assert (out / "failed.jsonl").read_text() == rows
    assert main(["dataset", "repair", str(out)]) == 0
    assert not (out / "failed.jsonl").exists()


def test_what_is_not_the_cases_fault_stops_all(
    project: Path,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A folder that cannot be written and a device that is not there: told, no case blamed."""
    out = tmp_path / "set"
    with monkeypatch.context() as patch:
        patch.setenv("WORKBENCH_DEVICE", "toaster")
        assert main(words(project, out, "--solver", "mpm")) == 3
    assert "WORKBENCH_DEVICE is 'toaster'" in capsys.readouterr().err
    data = DataSet.open(out)
    (out / "cases").mkdir()
    for case in data.cases():
        (out / "cases" / case.id).write_text("in the way")
    assert main(words(project, out, "--solver", "mpm")) == 3
    assert "cannot write" in capsys.readouterr().err
    assert not (out / "failed.jsonl").exists() and not (out / "lock").exists()
    for case in data.cases():
        (out / "cases" / case.id).unlink()
    assert main(words(project, out, "--solver", "mpm", "--jobs", "2")) == 0
    assert len(list(data.samples())) == 4
