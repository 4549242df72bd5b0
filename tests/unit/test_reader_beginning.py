"""What the reader of a calibrated design begins from, where it lies, and what it is shown by."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim.optics.studio.unit_residual import unit_bytes
from sim.reading.network.reader_file import reader_bytes
from sim.reading.network.spec import SIZES, ReaderSpec
from tests.made_readers import reader_file
from workbench.core.base.errors import DesignError
from workbench.core.design.design import SensorDesign
from workbench.core.design.unit import unit
from workbench.learning.dataset.variation import Looks
from workbench.learning.readers.beginning import named_start, usual_path, usual_start
from workbench.learning.readers.built import JUDGING, LEFT, built_sights
from workbench.learning.readers.presses import press_recipe
from workbench.project.named_designs import load_design
from workbench.project.project import Project


def calibrated(design: SensorDesign, grey: int = 90) -> SensorDesign:
    """A design of one built sensor, which is this grey at rest."""
    camera = design.optics.camera
    idle = np.full((camera.height_px, camera.width_px, 3), grey, np.uint8)
    png = cv2.imencode(".png", idle)[1].tobytes()
    data = unit_bytes(png, np.zeros((0, 4)), np.zeros((0, 3)), np.ones(4))
    optics = dataclasses.replace(design.optics, unit=unit("unit.npz", data))
    return dataclasses.replace(design, optics=optics)


def test_a_calibrated_design_begins_from_the_reader_of_its_design(tmp_path: Path) -> None:
    """The one that ships, unless the project has one; a design as drawn begins from nothing."""
    project, pad = Project(tmp_path), load_design("pad")
    assert usual_start(pad, project, "") is None
    shipped = usual_start(calibrated(pad), project, "")
    assert shipped is not None
    assert shipped.design == "pad"
    assert shipped.spec.widths == SIZES["full"]
    own = reader_file(design="pad", spec=ReaderSpec(widths=(8, 8, 12, 12), rows=240))
    path = usual_path(pad, project)
    path.parent.mkdir(parents=True)
    path.write_bytes(reader_bytes(own))
    found = usual_start(calibrated(pad), project, "")
    assert found is not None
    assert found.spec == own.spec
    # Of the size that is asked for.
    asked = usual_start(calibrated(pad), project, "full")
    assert asked is not None
    assert asked.spec == shipped.spec
    assert usual_start(calibrated(load_design("trunk")), project, "") is None


def test_each_built_sensor_has_a_file_of_its_own(tmp_path: Path) -> None:
    """Beside that of the design, which stays; none begins from itself or from another sensor."""
    project, pad = Project(tmp_path), load_design("pad")
    one = calibrated(pad)
    paths = {usual_path(each, project) for each in (pad, one, calibrated(pad, 91))}
    assert len(paths) == 3
    assert len({path.parent for path in paths}) == 1
    path = usual_path(one, project)
    path.parent.mkdir(parents=True)
    small = reader_file(design="pad", spec=ReaderSpec(widths=(8, 8), rows=240))
    for each in (path, usual_path(calibrated(pad, 91), project)):
        each.write_bytes(reader_bytes(small))
    found = usual_start(one, project, "")
    assert found is not None
    assert found.spec.widths == SIZES["full"]


def test_a_reader_of_other_images_is_no_beginning(tmp_path: Path) -> None:
    """By name, before anything is pressed."""
    path = tmp_path / "made.reader.npz"
    path.write_bytes(reader_bytes(reader_file()))
    with pytest.raises(DesignError, match="48 x 32 pixels"):
        named_start(path, load_design("pad"), "")
    path.write_bytes(reader_bytes(reader_file(spec=ReaderSpec(widths=(8, 8), rows=240))))
    assert named_start(path, load_design("pad"), "").spec.widths == (8, 8)
    with pytest.raises(DesignError, match="widths"):
        named_start(path, load_design("pad"), "small")


def test_a_calibrated_design_is_seen_by_sensors_that_are_off_by_less() -> None:
    """In light and camera, each by what a calibration leaves."""
    pad = load_design("pad")
    drawn, known = (
        built_sights(press_recipe(each, judged=False), 3) for each in (pad, calibrated(pad))
    )
    assert len(drawn) == len(known) == 3 + JUDGING
    for sights, off in ((drawn, Looks()), (known, LEFT)):
        moved = [
            abs(mine - own)
            for sight in sights
            for mine, own in zip(
                sight.optics.camera.position_mm, pad.optics.camera.position_mm, strict=True
            )
        ]
        assert 0.5 * off.camera_mm < max(moved) <= off.camera_mm
        powers = [power for sight in sights for power in sight.optics.ring.powers]
        assert 0.5 * off.power_share < max(powers) - 1.0 <= off.power_share
