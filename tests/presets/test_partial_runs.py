"""A press that fails on its way leaves what settled: files, numbers, and one message."""

from __future__ import annotations

import csv
import json
import re
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

from tests.presets.conftest import Command
from workbench.pipeline.store import Store
from workbench.planning.running import PARTIAL
from workbench.system.folder import RUN_FILES, prepare

pytestmark = pytest.mark.slow

SOFT = (
    "--indenter sphere --size-mm 4 --target 0,0,16 --depth-mm 1.5 --frames 2 --grid-mm 0.8 "
    "--penalty 1"
).split()
"""Contact a hundred times softer than usual or more: at 0.75 mm the ball overlaps the skin by
0.22 mm, at 1.5 mm by 0.49 mm, of which 0.4 mm are allowed."""


def test_a_press_that_fails_on_its_way_leaves_what_settled(
    workbench: Command, project: Path, coarse: Path, tmp_path: Path
) -> None:
    """Exit 3 in frame 2 of 2; frame 1 is there as image, rows, arrays and VTK; again it is found.

    A press that does settle then writes both frames into the same folder.
    """
    out = tmp_path / "out"
    for _ in range(2):
        run = workbench("run", coarse, *SOFT, "--out", out)
        assert run.code == 3
        errors = [line for line in run.stderr.splitlines() if line.startswith("error: ")]
        (message,) = errors
        assert message.startswith("error: frame 2 of 2: skin and object overlap by 0.4")
        assert message.endswith(f"the limit is 0.400 mm; frame 1 settled and is in {out}")
        assert " hint: lower contact.grid_mm" in run.stderr
        assert run.lines[-1]["at"] == "contact.grid_mm"
    assert "press" not in run.keys()
    assert {"build", "mesh", "lattice", "bake"} <= set(run.keys())

    summary = json.loads((out / "summary.json").read_text())
    failed = summary["failed"]
    assert (failed["stage"], failed["frame"], failed["frames"]) == ("press", 2, 2)
    assert failed["settled"] == 1
    assert failed["hint"]
    assert summary["images"] == ["background.png", "frame_000.png"]
    assert len(summary["contact"]["frames"]) == 1
    names = {path.name for path in out.iterdir()}
    assert {"contact_000.vtp", "contact.pvd", "membrane.vtp", "poses.csv"} <= names
    assert not names & {"contact_001.vtp", "frame_001.png", "report.html", "moulds"}
    rows = list(csv.DictReader((out / "forces.csv").open()))
    assert [row["frame"] for row in rows] == ["1"]
    assert float(rows[0]["normal_N"]) == pytest.approx(summary["contact"]["normal_N"], rel=1e-8)
    with np.load(out / "contact.npz") as arrays:
        assert len(arrays["reaction_N"]) == 1
    assert len((out / "poses.csv").read_text().splitlines()) == 3

    kept = list((Store(project / "store").root / PARTIAL).iterdir())
    assert len(kept) == 1
    done = workbench("run", coarse, *SOFT[:-2], "--out", out)
    assert done.code == 0
    assert "failed" not in json.loads((out / "summary.json").read_text())
    assert (out / "contact_001.vtp").exists()
    assert kept[0].exists()
    # What the next run clears is all that this one wrote.
    prepare(out, clear=RUN_FILES)
    assert [path for path in out.rglob("*") if path.is_file()] == []


def test_ctrl_c_keeps_the_frames_that_had_settled(
    project: Path, coarse: Path, tmp_path: Path
) -> None:
    """Asked to stop in frame 3 or later of 60: within 3 s the command has ended with 130, and
    forces, arrays and VTK files hold what had settled; nothing else is there.
    """
    out = tmp_path / "out"
    words = f"run {coarse} --indenter sphere --size-mm 4 --target 0,0,16 --depth-mm 1 --frames 60"
    command = [sys.executable, "-m", "workbench.cli", *words.split(), "--grid-mm", "0.8"]
    command += ["--project", str(project), "--out", str(out), "--json"]
    with subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as run:
        assert run.stdout is not None
        assert run.stderr is not None
        # Progress comes five times a second at most, so any one frame may go by untold.
        notes = (json.loads(line).get("note", "") for line in run.stdout)
        frames = (int(told[1]) for note in notes if (told := re.search(r"frame (\d+) of 60", note)))
        assert next(frame for frame in frames if frame >= 3) < 50
        run.send_signal(signal.SIGINT)
        asked = time.monotonic()
        run.stdout.read()
        said = run.stderr.read()
        assert run.wait() == 130
        assert time.monotonic() - asked < 3.0
    rows = list(csv.DictReader((out / "forces.csv").open()))
    assert 2 <= len(rows) < 60
    assert f"cancelled; frames 1 to {len(rows)} settled and are in {out}" in said
    with np.load(out / "contact.npz") as arrays:
        assert len(arrays["reaction_N"]) == len(rows)
    assert (out / "contact_001.vtp").exists()
    assert not (out / "summary.json").exists()
