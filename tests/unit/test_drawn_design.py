"""Which design a built sensor was drawn as, and what the command says of it."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sim.optics.studio.unit_residual import unit_bytes
from workbench.calibration.residual import REACH
from workbench.cli.command_line import main
from workbench.core.design.design import SensorDesign
from workbench.core.design.unit import unit
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading.relit_reader import drawn_design
from workbench.report.image_files import png_bytes

UNIT = unit_bytes(
    png_bytes(np.full((480, 640, 3), 90, np.uint8)), np.zeros((0, 4)), np.zeros((0, 3)), REACH
)
"""Of a sensor that shows nothing beyond its design."""


def calibrated(name: str) -> SensorDesign:
    """A pad with a unit file, under a name."""
    design = load_design("pad").replace("optics.coating.albedo", 0.31)
    optics = dataclasses.replace(design.optics, unit=unit("unit.npz", UNIT))
    return dataclasses.replace(design, name=name, optics=optics)


def test_a_built_sensor_has_the_design_of_its_name(tmp_path: Path) -> None:
    """The preset; a design that the project keeps under that name comes before it."""
    project = Project(tmp_path / "p")
    found = drawn_design(calibrated("pad"), project)
    assert found == load_design("pad")
    mine = load_design("pad").replace("layers.elastomer_mm", 2.5)
    project.save_design("pad", mine)
    found = drawn_design(calibrated("pad"), project)
    assert found is not None
    assert found.layers.elastomer_mm == 2.5


def test_a_built_sensor_is_not_what_it_was_drawn_as(tmp_path: Path) -> None:
    """Kept in the project under the name of its design, it is passed over."""
    project = Project(tmp_path / "p")
    project.save_design("pad", calibrated("pad"))
    assert drawn_design(calibrated("pad"), project) == load_design("pad")


def test_nothing_is_guessed(tmp_path: Path) -> None:
    """Of a design that is not calibrated, or whose name nobody knows."""
    project = Project(tmp_path / "p")
    assert drawn_design(load_design("pad"), project) is None
    assert drawn_design(calibrated("of_mine"), project) is None
    assert drawn_design(calibrated("a/b"), project) is None


def test_a_drawn_design_is_for_calibrated_ones(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Told at once, with what to do; and one that does not exist, by its name."""
    idle = tmp_path / "idle.png"
    idle.write_bytes(png_bytes(np.full((480, 640, 3), 90, np.uint8)))
    words = ["read", "--project", str(tmp_path / "p"), "pad", str(idle), "--idle", str(idle)]
    words += ["--out", str(tmp_path / "out"), "--set", "optics.coating.albedo=0.31"]
    assert main([*words, "--reader", "learned", "--drawn", "pad"]) == 2
    assert "workbench calibrate" in capsys.readouterr().err
    assert main([*words, "--drawn", "pad"]) == 2
    assert "--reader learned" in capsys.readouterr().err
    assert not (tmp_path / "out" / "reading.json").exists()


@pytest.mark.parametrize("words", [(), ("--drawn", "no_such")])
def test_without_a_drawn_design_a_training_is_asked_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], words: tuple[str, ...]
) -> None:
    """As for any other sensor that no reader knows."""
    project = Project(tmp_path / "p")
    path = project.save_design("of_mine", calibrated("of_mine"))
    path = path.rename(tmp_path / "built.toml")
    idle = tmp_path / "idle.png"
    idle.write_bytes(png_bytes(np.full((480, 640, 3), 90, np.uint8)))
    given = ["read", "--project", str(tmp_path / "p"), str(path), str(idle), "--idle", str(idle)]
    given += ["--out", str(tmp_path / "out"), "--reader", "learned"]
    assert main([*given, *words]) == 2
    told = capsys.readouterr().err
    assert ("no_such" if words else "workbench reader train") in told
