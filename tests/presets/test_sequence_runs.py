"""The trunk's grip from the command line: images, forces and a report of every frame."""

from __future__ import annotations

import csv
import json
import re
from pathlib import Path

import numpy as np
import pytest

from tests.presets.conftest import Command

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("shared_results")]

TRUNK = """\
schema = 1
name = "coarse_trunk"
family = "trunk"
[meshing]
hex_mm = 1.0
[optics.camera]
width_px = 160
height_px = 120
"""
FRAMES = 5
"""One each to press, close and open, two to lift."""


def test_a_grip_is_run_and_shown_frame_by_frame(workbench: Command, tmp_path: Path) -> None:
    """Five frames and the background; drives pull in frame 2 only; the report tells of them."""
    import cv2

    design, out = tmp_path / "trunk.toml", tmp_path / "out"
    design.write_text(TRUNK)
    # Images are compared with each other: any light shows the lobes move.
    words = "--sequence grip --frames 1 --grid-mm 1.5 --light-model direct".split()
    assert workbench("run", design, *words, "--out", out).code == 0
    summary = json.loads((out / "summary.json").read_text())
    assert summary["images"] == ["background.png", *(f"frame_{k:03d}.png" for k in range(FRAMES))]
    seen = [np.asarray(cv2.imread(str(out / name)), dtype=int) for name in summary["images"]]
    background, pressed, closed, _, _, lifted = seen
    changes = [np.abs(image - background).mean() for image in (pressed, closed, lifted)]
    assert changes[1] > changes[0] > 10.0 * changes[2]

    rows = list(csv.DictReader((out / "forces.csv").open()))
    assert [row["frame"] for row in rows] == [str(k + 1) for k in range(FRAMES)]
    drives_N = np.array([[float(row[f"actuator_{n}_y_N"]) for n in range(4)] for row in rows])
    # Top and back of the lobe at +Y push toward -Y, those of the other one toward +Y.
    lobes_N = drives_N[:, :2] + drives_N[:, 2:]
    assert lobes_N[1, 0] < -0.5
    assert lobes_N[1, 1] > 0.5
    assert np.abs(drives_N[[0, 2, 3, 4]]).max() < 0.1
    reported_N = [force[1] for force in summary["contact"]["frames"][1]["actuator_N"]]
    assert reported_N == pytest.approx(drives_N[1].tolist())
    report = (out / "report.html").read_text()
    assert "Driven parts" in report
    assert "forces.csv" in report
    assert not (out / "slip.csv").exists()
    text = "".join(path.read_text() for path in (out / "forces.csv", out / "summary.json"))
    assert not re.search(r"\bnan\b", text, re.IGNORECASE)
