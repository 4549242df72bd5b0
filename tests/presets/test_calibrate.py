"""`workbench calibrate` on photographs of a twin: a sensor whose hidden powers are known.

The photographs come from this program, so they show that the fit finds what it should, not that
light is right: `workbench validate published` and the report's scores on real photographs do that.
"""

from __future__ import annotations

import csv
import json
from pathlib import Path

import cv2
import numpy as np
import pytest

import workbench as wb
from tests.photographed_pad import photographed_pad
from workbench.calibration.seen.photo_set import COLUMNS
from workbench.cli import main
from workbench.project.design_toml import design_from_toml, design_to_toml

pytestmark = pytest.mark.slow

BALL_MM, DEPTH_MM = 9.0, 0.8
PLACES = ((0.0, 0.0), (3.0, 2.0), (-3.0, 1.5), (2.0, -3.0), (-2.5, -2.0), (0.5, 3.0), (-1.0, -3.5))
HIDDEN = (1.15, 0.85, 1.0, 0.9, 1.2, 1.05)
"""Powers of the six LEDs that the calibration is not told."""


def design() -> wb.Design:
    """A small flat pad, seen by a small camera."""
    return photographed_pad(240, 180, 500_000)


@pytest.fixture(scope="module")
def photos(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Photographs of the twin with its hidden powers, other photons, and their table."""
    where = tmp_path_factory.mktemp("photos")
    twin = design().replace("optics.ring.powers", HIDDEN).replace("optics.baking.seed", 7)
    top_mm = wb.evaluate(twin).mesh.outer.points_mm[:, 2].max()
    rows = []
    for number, (x, y) in enumerate(PLACES):
        press = wb.Press(target_mm=(x, y, float(top_mm)), depth_mm=DEPTH_MM, frames=2)
        settings = wb.ContactSettings(grid_mm=0.8)
        images = wb.evaluate(twin, wb.Indenter(size_mm=BALL_MM), press, settings=settings).images
        name = f"p{number}.png"
        cv2.imwrite(str(where / name), images[-1][:, :, ::-1])
        cv2.imwrite(str(where / "idle.png"), images[0][:, :, ::-1])
        rows.append((name, BALL_MM, "", "", "", DEPTH_MM, ""))
    with (where / "presses.csv").open("w", newline="") as file:
        csv.writer(file).writerows([COLUMNS, *rows])
    return where


@pytest.fixture(scope="module")
def calibrated(photos: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the command leaves of the design and the photographs, two of them held out."""
    folder = tmp_path_factory.mktemp("calibrated")
    (folder / "pad.toml").write_text(design_to_toml(design()))
    out = folder / "out"
    words = [str(folder / "pad.toml"), "--photos", str(photos), "--out", str(out)]
    words += ["--lights", "known", "--refine", "powers", "--project", str(folder / "project")]
    assert main(["calibrate", *words, "--hold-out", "p5,p6"]) == 0
    return out


def test_hidden_powers_are_found(calibrated: Path) -> None:
    """Relative powers within 3 %, each LED its own colour; held-out photographs above the null."""
    figures = json.loads((calibrated / "calibration.json").read_text())
    powers = np.array([each["power_rgb"] for each in figures["fitted"]["lights"]])
    strongest = powers.argmax(axis=1)
    assert strongest.tolist() == [0, 0, 1, 1, 2, 2]
    own = powers.max(axis=1)
    assert own / own.mean() == pytest.approx(np.array(HIDDEN) / np.mean(HIDDEN), rel=0.03)
    assert (powers.sum(axis=1) - own).max() < 0.03
    for each in figures["photos"]:
        assert each["psnr_dB"] > each["null_psnr_dB"] + 10.0
        assert each["depth_mm"] == DEPTH_MM
        assert (calibrated / "predicted" / each["photo"]).is_file()
    assert [each["photo"] for each in figures["photos"] if each["held_out"]] == ["p5.png", "p6.png"]
    assert figures["idle"]["psnr_dB"] > 35.0


def test_the_calibrated_design_is_a_design(photos: Path, calibrated: Path) -> None:
    """It names its unit beside it, and images of it show the photograph at rest."""
    found = design_from_toml((calibrated / "calibrated.toml").read_text(), roots=(calibrated,))
    assert found.optics.ring.count == 6 and not found.optics.lamps, "the ring stays where it is"
    assert found.optics.unit is not None and found.optics.unit.name == "unit.npz"
    idle = cv2.imread(str(photos / "idle.png"))[:, :, ::-1]
    assert np.array_equal(wb.evaluate(found, press=wb.Press(frames=1)).images[0], idle)
