"""Every shipped preset goes the whole way: pressed, seen, moulded, and nothing in it collides."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from geometry.housing.led_holder import LEAST_WALL_MM
from workbench.core.design.design import SensorDesign
from workbench.core.press.press import ContactSettings
from workbench.core.result.fabrication import Severity
from workbench.project.named_designs import load_design, presets

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("shared_results")]

FAMILIES = ("trunk", "paw", "thumb", "tentacle", "pad", "digitac")
STAGES = ["build", "mesh", "lattice", "bake", "press", "shoot"]
STAGES += ["mould", "housing", "recipe", "package"]
OPTIONS = "--depth-mm 0.8 --frames 1 --grid-mm 0.8".split()
# A grainy light shows a dent as well, and is traced in a tenth of the time.
OPTIONS += "--set optics.baking.photons=400000 --out".split()
SEEN_GREY = 10
"""A change of a pixel that an eye sees [grey levels of 255]."""


@pytest.mark.parametrize("name", FAMILIES)
def test_a_preset_is_pressed_seen_and_moulded(workbench: Any, tmp_path: Path, name: str) -> None:
    """Exit 0; all stages; a settled push outward; a dent in the image; closed single mould parts;
    no red check."""
    import cv2

    done = workbench("run", name, *OPTIONS, tmp_path)
    assert done.code == 0, done.stderr
    summary = json.loads((tmp_path / "summary.json").read_text())
    stages = [row["stage"] for row in summary["stages"]]
    assert stages in (STAGES, [*STAGES, "picture"])
    assert summary["family"] == name
    assert summary["contact"]["normal_N"] > 0.05
    assert summary["contact"]["residual"] <= ContactSettings().tolerance
    assert 0.0 < summary["contact"]["penetration_mm"] < 0.05 * 0.8
    assert summary["images"] == ["background.png", "frame_000.png"]
    before, after = (cv2.imread(str(tmp_path / image)) for image in summary["images"])
    assert before is not None
    assert after is not None
    changed = np.abs(after.astype(int) - before).max(axis=2) >= SEEN_GREY
    # A dent 15 pixels wide; the noise of the renderer is a single grey level.
    assert changed.sum() > 150
    assert len(summary["moulds"]) >= 3
    for row in summary["moulds"]:
        part = trimesh.load_mesh(tmp_path / row["file"])
        assert row["watertight"] is True
        assert part.is_watertight
        assert part.body_count == 1
    assert [check for check in summary["checks"] if check["severity"] == "bad"] == []


@pytest.mark.parametrize("name", sorted(presets()))
def test_leds_and_camera_of_a_preset_have_their_gaps(
    made: Callable[[SensorDesign, str], Any], name: str
) -> None:
    """At least the 0.15 mm of `housing.clearance_mm` around every LED and the camera; the LEDs'
    holder stands, and every wall has 0.8 mm."""
    design = load_design(name)
    housing = made(design, "housing")
    gaps = {check.name: check for check in housing.checks if check.name.endswith("_clearance")}
    assert gaps.keys() == {"led_clearance", "camera_clearance"}
    for check in gaps.values():
        # The kernel's boxes and gaps are good to a thousandth.
        assert check.value >= design.housing.clearance_mm - 1e-3, check.message
    assert all(check.severity is not Severity.BAD for check in housing.checks)
    (seat,) = (check for check in housing.checks if check.name == "led_holder_seat")
    assert seat.severity is Severity.GOOD, seat.message
    walls = {check.part: check for check in housing.checks if check.name == "minimum_wall"}
    # Two lines of a nozzle, in every part.
    assert min(check.value for check in walls.values()) >= LEAST_WALL_MM - 1e-6
