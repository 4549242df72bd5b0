"""Bad input to contact typed on the command line: refused in time, nothing lost, or told.

With `test_bad_motion.py` (paths, depth, material) and `test_bad_input.py` (holes, huge files).
"""

from __future__ import annotations

import json
import tracemalloc
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from tests.presets.test_bad_motion import BALL, PRESS, refused, write

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("shared_results")]

GRID = ("--grid-mm", "0.8")


def test_more_particles_than_memory_is_refused_and_the_good_press_is_kept(
    workbench: Any, coarse: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With 1 MiB free: particles, need and limit in one message; afterwards all is found again."""
    words = ("run", coarse, *BALL, *PRESS, "--out", tmp_path / "out")
    assert workbench(*words).code == 0
    monkeypatch.setattr("sim.contact.engine.memory.free_bytes", lambda: 2.0**20)
    deeper = ("run", coarse, *BALL, *PRESS[:3], "0.6", *PRESS[4:], "--out", tmp_path / "deeper")
    run = workbench(*deeper)
    refused(run, "million particles need 0.", "contact.grid_mm")
    assert "0.0 GiB of memory may be used" in run.stderr
    assert "hint: raise contact.grid_mm, or lower contact.active_radius_mm" in run.stderr
    again = workbench(*words)
    assert again.code == 0
    assert again.computed() == []


def test_scan_of_five_million_triangles_is_refused_unread(
    workbench: Any, coarse: Path, tmp_path: Path
) -> None:
    """250 MB as binary STL; the refusal takes less than a tenth of that in memory."""
    scan = tmp_path / "scan.stl"
    with scan.open("wb") as file:
        file.write(bytes(80) + np.uint32(5_000_000).tobytes())
        file.truncate(84 + 50 * 5_000_000)
    tracemalloc.start()
    run = workbench("run", coarse, "--indenter", scan, *GRID, *PRESS, "--out", tmp_path / "out")
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    refused(run, "scan.stl has 250 MB, more than 64 MB", "indenter")
    assert "hint: reduce the mesh to under 1,000,000 triangles before loading it" in run.stderr
    assert peak < 25e6
    assert run.keys() == {}


def test_scan_of_too_many_triangles_below_the_size_limit_is_refused(
    workbench: Any, coarse: Path, tmp_path: Path
) -> None:
    """1.2 million triangles are 60 MB: read, counted, and refused before they are welded."""
    scan = tmp_path / "scan.stl"
    count = 1_200_000
    with scan.open("wb") as file:
        file.write(bytes(80) + np.uint32(count).tobytes())
        file.write(np.random.default_rng(0).random((count, 50)).astype(np.uint8).tobytes())
    run = workbench("run", coarse, "--indenter", scan, *GRID, *PRESS, "--out", tmp_path / "out")
    refused(run, "scan.stl has 1,200,000 triangles, more than 1,000,000", "indenter")


def test_open_mesh_is_refused_with_the_number_of_open_edges(
    workbench: Any, coarse: Path, tmp_path: Path
) -> None:
    """A cylinder of 32 sides without its lower end, as a scanner leaves it: 32 open edges."""
    can = trimesh.creation.cylinder(radius=2.0, height=4.0, sections=32)
    can.update_faces(can.face_normals[:, 2] > -0.5)
    tool = tmp_path / "tool.stl"
    can.export(tool)
    run = workbench("run", coarse, "--indenter", tool, *GRID, *PRESS, "--out", tmp_path / "out")
    refused(run, "tool.stl is not watertight: 32 open edges", "indenter")


def test_inside_out_mesh_is_turned_and_told(workbench: Any, coarse: Path, tmp_path: Path) -> None:
    """The force of the same mesh the right way round, and a notice on stderr."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=2.0)
    forces = []
    for name in ("right", "turned"):
        tool = tmp_path / f"{name}.stl"
        ball.export(tool)
        ball.invert()
        out = tmp_path / name
        run = workbench("run", coarse, "--indenter", tool, *GRID, *PRESS, "--out", out)
        assert run.code == 0, run.stderr
        forces.append(json.loads((out / "summary.json").read_text())["contact"]["normal_N"])
        told = "turned.stl was inside out and has been turned"
        assert (told in run.stderr) == (name == "turned")
    # Same triangles in another order of corners: only rounding tells the samples apart.
    assert forces[1] == pytest.approx(forces[0], rel=1e-3)


def test_sensor_that_starts_inside_the_object_is_refused(
    workbench: Any, coarse: Path, tmp_path: Path
) -> None:
    """A ball of radius 2 mm whose centre stands on the tip, while the sensor sinks away."""
    rows = ((0, 0, 0, 0, 1, 0, 0, 0), (1, 0, 0, -3, 1, 0, 0, 0))
    path = write(tmp_path / "down.csv", *rows)
    words = ("--trajectory", path, "--mover", "sensor", "--object-pose", "0,0,16,1,0,0,0")
    run = workbench("run", coarse, *BALL, *words, "--out", tmp_path / "out")
    refused(run, "the trajectory starts inside the membrane: in row 1", "press.trajectory")


def test_object_larger_than_the_sensor_is_pressed_or_refused(
    workbench: Any, coarse: Path, tmp_path: Path
) -> None:
    """A cube of 101 mm is over the limit; a cube of 60 mm presses the tip like a plate."""
    words = ("--indenter", "cube", *GRID, *PRESS)
    run = workbench("run", coarse, *words, "--size-mm", "101", "--out", tmp_path / "huge")
    refused(run, "indenter size 101 mm is outside 0.5 to 100 mm", "indenter.size_mm")
    run = workbench("run", coarse, *words, "--size-mm", "60", "--out", tmp_path / "out")
    assert run.code == 0, run.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["contact"]["normal_N"] > 0.0
