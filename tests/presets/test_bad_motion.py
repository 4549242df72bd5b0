"""Bad motion and material typed on the command line: exit 2, one message, nothing computed after.

Also that what is odd but allowed is told, and that a run's poses can be run again.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from workbench.core.press.trajectory import COLUMNS

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("shared_results")]

BALL = "--indenter sphere --size-mm 4 --grid-mm 0.8".split()
PRESS = "--target 0,0,16 --depth-mm 0.5 --frames 1".split()
HEADER = ",".join(COLUMNS)


def refused(run: Any, text: str, at: str) -> None:
    """Exit 2 and one message with its field and a remedy, as text and as JSON; no press."""
    assert run.code == 2, run.stderr
    first, *rest = run.stderr.splitlines()
    assert first.startswith("error: "), run.stderr
    assert text in first
    assert any(line.strip() == f"at: {at}" for line in rest)
    assert any(line.strip().startswith("hint: ") for line in rest)
    assert sum(line.startswith("error: ") for line in run.stderr.splitlines()) == 1
    assert "Traceback" not in run.stderr
    assert run.lines[-1]["at"] == at
    assert "press" not in run.keys()


def write(path: Path, *rows: tuple[float, ...], header: str = HEADER) -> Path:
    """A CSV file."""
    path.write_text("\n".join([header, *(",".join(map(str, row)) for row in rows), ""]))
    return path


OPTIONS = {
    "negative depth": (
        ["--depth-mm", "-1"],
        "press depth -1 mm is outside 0 to 50",
        "press.depth_mm",
    ),
    "50 mm": (["--depth-mm", "50"], "largest depth that fits is 1.9 mm", "press.depth_mm"),
    "51 mm": (["--depth-mm", "51"], "press depth 51 mm is outside 0 to 50 mm", "press.depth_mm"),
    "unknown stroke": (["--stroke", "slid:1,0"], "there is no stroke 'slid'", "press.strokes"),
    "stroke too deep": (
        ["--stroke", "press:4:2"],
        "frame 2 of 3 (stroke 1, press:4): the object reaches",
        "press.strokes",
    ),
    "time without path": (["--every-s", "1"], "without a trajectory", "--every-s"),
    "pose without path": (
        ["--object-pose", "0,0,20,1,0,0,0"],
        "an object pose but no trajectory",
        "press.object_pose",
    ),
    "pose of six": (["--object-pose", "0,0,20,1,0,0"], "expected 7 numbers", "--object-pose"),
}


@pytest.mark.parametrize("case", OPTIONS)
def test_bad_options_are_refused(workbench: Any, coarse: Path, tmp_path: Path, case: str) -> None:
    """Value, limit and remedy."""
    words, text, at = OPTIONS[case]
    run = workbench("run", coarse, *BALL, *PRESS, *words, "--out", tmp_path / "out")
    refused(run, text, at)


LEAVES = ((0, 0, 0, 20, 1, 0, 0, 0), (1, 0, 0, 900, 1, 0, 0, 0))
DIVES = ((0, 0, 0, 20, 1, 0, 0, 0), (1, 0, 0, 17.5, 1, 0, 0, 0), (2, 0, 0, 14, 1, 0, 0, 0))
PATHS = {
    "missing column": (((0, 0, 0, 20),), "the column qw is missing"),
    "leaves the scene": (LEAVES, "row 2: the trajectory leaves the scene, 900 mm from the sensor"),
    "starts inside": (DIVES[1:], "the trajectory starts inside the membrane: in row 1"),
    "never touches": ((LEAVES[0], (1, 9, 0, 20, 1, 0, 0, 0)), "the trajectory never touches"),
    "meets the support": (DIVES, "(row 3 of the trajectory): the object reaches"),
    "a word": ((LEAVES[0], (1, 0, "low", 17, 1, 0, 0, 0)), "row 2 (line 3), column y_mm: 'low'"),
    "time stands": ((LEAVES[0], LEAVES[0]), "row 2: t_s 0 s does not come after 0 s of row 1"),
    "one row": (LEAVES[:1], "has 1 rows of poses; a trajectory needs at least 2"),
}


@pytest.mark.parametrize("case", PATHS)
def test_bad_trajectories_are_refused(
    workbench: Any, coarse: Path, tmp_path: Path, case: str
) -> None:
    """What is wrong with the file or the path, and in which row."""
    rows, text = PATHS[case]
    header = HEADER if len(rows[0]) == 8 else "t_s,x_mm,y_mm,z_mm"
    file = write(tmp_path / "path.csv", *rows, header=header)
    run = workbench("run", coarse, *BALL, "--trajectory", file, "--out", tmp_path / "out")
    refused(run, text, "press.trajectory")


MATERIALS = {
    "Pa": ("young_MPa = 145000.0", "145000 MPa is outside", "material.young_MPa", "type 0.145;"),
    "friction": (
        "friction = -0.1",
        "friction coefficient -0.1 is outside 0",
        "material.friction",
        "",
    ),
    "poisson": (
        "poisson = 0.5",
        "ratio 0.5 is outside 0 to 0.495",
        "material.poisson",
        "cannot be",
    ),
}


@pytest.mark.parametrize("case", MATERIALS)
def test_bad_materials_are_refused(workbench: Any, coarse: Path, tmp_path: Path, case: str) -> None:
    """1.45e5 Pa typed as MPa is recognised; mu < 0 and nu = 0.5 are out of range."""
    line, text, at, remedy = MATERIALS[case]
    file = tmp_path / "bad.toml"
    file.write_text(f"{coarse.read_text()}[material]\n{line}\n")
    run = workbench("run", file, *BALL, *PRESS, "--out", tmp_path / "out")
    refused(run, text, at)
    assert remedy in run.stderr


def test_odd_but_allowed_is_told(workbench: Any, coarse: Path, tmp_path: Path) -> None:
    """145 MPa and a press of 0 mm: exit 0, a notice each on stderr and in the summary, no force."""
    file = tmp_path / "stiff.toml"
    file.write_text(f"{coarse.read_text()}[material]\nyoung_MPa = 145.0\n")
    words = ("--target", "0,0,16", "--depth-mm", "0", "--frames", "1")
    run = workbench("run", file, *BALL, *words, "--out", tmp_path / "out")
    assert run.code == 0, run.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert "if it was meant in kPa, type 0.145" in summary["notices"]["material"]
    assert "press depth 0 mm is first touch" in summary["notices"]["press"]
    for notice in (summary["notices"]["material"], summary["notices"]["press"]):
        assert f"notice: {notice}" in run.stderr
    # Distances are rounded: a point may lie an atom's width inside.
    assert abs(summary["contact"]["normal_N"]) < 1e-12


def test_poses_of_a_run_can_be_run_again(workbench: Any, coarse: Path, tmp_path: Path) -> None:
    """Press, slide and release; the same path from poses.csv has the same forces, then none."""
    first, again = tmp_path / "first", tmp_path / "again"
    strokes = ("--stroke", "slide:0.2,0:1", "--stroke", "release:0.5:1")
    run = workbench("run", coarse, *BALL, *PRESS, *strokes, "--out", first)
    assert run.code == 0, run.stderr
    run = workbench("run", coarse, *BALL, "--trajectory", first / "poses.csv", "--out", again)
    assert run.code == 0, run.stderr
    with np.load(first / "contact.npz") as one, np.load(again / "contact.npz") as two:
        np.testing.assert_allclose(two["indenter_pose"], one["indenter_pose"], atol=1e-9)
        force = np.linalg.norm(one["reaction_N"], axis=1)
        assert force[-1] == 0.0
        # Another middle of the region: its radius may cost 0.3 % of the force, settling 0.1 %.
        np.testing.assert_allclose(np.linalg.norm(two["reaction_N"], axis=1), force, rtol=1e-2)
    old, new = (folder / "poses.csv" for folder in (first, again))
    numbers = [np.loadtxt(path, delimiter=",", skiprows=1) for path in (old, new)]
    np.testing.assert_allclose(numbers[1], numbers[0], atol=1e-9)
    summary = json.loads((first / "summary.json").read_text())
    depths = [frame["depth_mm"] for frame in summary["contact"]["frames"]]
    # A release ends half a millimetre above the skin, which curves away: R 8 under R 2.
    np.testing.assert_allclose(depths, [0.5, 0.5, -0.5], atol=0.02)


def test_sensor_moving_up_is_the_object_moving_down(
    workbench: Any, coarse: Path, tmp_path: Path
) -> None:
    """The sensor rises by 0.5 mm against a ball that stands on its tip: the force of the press."""
    still, rising = tmp_path / "still", tmp_path / "rising"
    run = workbench("run", coarse, *BALL, *PRESS, "--out", still)
    assert run.code == 0, run.stderr
    rows = ((0, 1, 2, 3, 1, 0, 0, 0), (1, 1, 2, 3.5, 1, 0, 0, 0))
    words = ("--trajectory", write(tmp_path / "up.csv", *rows), "--mover", "sensor")
    run = workbench("run", coarse, *BALL, *PRESS[:2], *words, "--out", rising)
    assert run.code == 0, run.stderr
    forces = [
        json.loads((folder / "summary.json").read_text())["contact"]["normal_N"]
        for folder in (still, rising)
    ]
    # The region has its middle among the covered vertices, not on the target: 0.3 % of the force.
    assert forces[1] == pytest.approx(forces[0], rel=1e-2)
    table = np.loadtxt(rising / "poses.csv", delimiter=",", skiprows=1)
    # The normal of the faceted tip is +Z to 1e-3.
    np.testing.assert_allclose(table, rows, atol=1e-3)
