"""A network by itself: what it says, on its own points and on others, and what it refuses."""

from __future__ import annotations

import ast
import dataclasses
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest

import workbench as wb
from sim.forces.network.spec import Target
from sim.forces.network.steady import steady_predictor
from sim.forces.network.weights import NetworkWeights
from tests.made_weights import tiny_weights, write_tiny
from workbench.cli import command_line
from workbench.cli.command import Command
from workbench.cli.command_line import main
from workbench.core.base.packages import OURS, missing_package
from workbench.learning.dataset.folder import SkinData

ROOT = Path(__file__).parents[2]


def grid(count: int, spacing_mm: float) -> SkinData:
    """A flat skin of count x count points."""
    lines = spacing_mm * np.arange(count)
    points = np.stack(
        [*np.meshgrid(lines, lines, indexing="ij"), np.zeros((count, count))], axis=-1
    )
    corner = np.arange(count * count).reshape(count, count)
    a, b, c, d = (
        part.ravel()
        for part in (corner[:-1, :-1], corner[1:, :-1], corner[1:, 1:], corner[:-1, 1:])
    )
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    points = points.reshape(-1, 3)
    return SkinData(points_mm=points, faces=faces, normals=points * 0, areas_mm2=points[:, 0])


def tiny(
    value: tuple[float, float, float] | None = None, target: Target = Target.FORCE, **card: float
) -> NetworkWeights:
    """A tiny network that was trained on `grid(12, 1.0)`."""
    return dataclasses.replace(tiny_weights(value, target, card), spacing_mm=11.0 / 12.0)


def test_it_says_what_the_predictor_says(tmp_path: Path) -> None:
    """On the points of the training, for one frame and for several."""
    weights, skin = tiny(), grid(12, 1.0)
    network = wb.ForceNetwork(write_tiny(tmp_path, weights), skin)
    moved = np.random.default_rng(1).normal(scale=0.1, size=(2, 144, 3)).astype(np.float32)
    predictor = steady_predictor(weights, skin.points_mm, skin.faces, device="cpu")
    found = network.force_N(moved)
    assert not network.needs_force
    for frame in range(2):
        np.testing.assert_array_equal(found[frame], predictor.predict(moved[frame]))
    np.testing.assert_array_equal(network.force_N(moved[1]), found[1])
    assert np.abs(found[0] - found[1]).max() > 1e-4


def test_forces_keep_their_sum_on_another_mesh(tmp_path: Path) -> None:
    """(0.25, 0, -0.5) N at each of 144 points: on 23 x 23 points the same sum."""
    path = write_tiny(tmp_path, tiny((0.25, 0.0, -0.5)))
    network = wb.ForceNetwork(path, grid(12, 1.0), on=grid(23, 0.5))
    found = network.force_N(np.zeros((529, 3)))
    assert found.shape == (529, 3)
    np.testing.assert_allclose(found.sum(axis=0), (36.0, 0.0, -72.0), rtol=1e-5)


def test_the_displacement_is_carried_to_the_networks_points(tmp_path: Path) -> None:
    """A linear field is the same on both meshes, and so is what the network makes of it."""
    path = write_tiny(tmp_path, tiny())
    coarse, fine = grid(12, 1.0), grid(23, 0.5)
    plain = wb.ForceNetwork(path, coarse).force_N(0.02 * coarse.points_mm)
    carried = wb.ForceNetwork(path, coarse, on=fine).force_N(0.02 * fine.points_mm)
    np.testing.assert_allclose(carried.sum(axis=0), plain.sum(axis=0), atol=1e-4)


def test_forces_are_in_proportion_to_young(tmp_path: Path) -> None:
    """Twice the modulus of the data card, under the same displacement: twice the force."""
    path = write_tiny(tmp_path, tiny((0.0, 0.0, -0.5), young_MPa=0.2))
    soft, stiff = (wb.ForceNetwork(path, grid(12, 1.0), young_MPa=E) for E in (0.2, 0.4))
    rest = np.zeros((144, 3))
    np.testing.assert_allclose(stiff.force_N(rest), 2.0 * soft.force_N(rest), rtol=1e-6)


def test_what_a_network_cannot_do_is_refused(tmp_path: Path) -> None:
    """A wrong shape, spacing or target, a missing force or skin, and an E with none to compare."""
    path = write_tiny(tmp_path, tiny())
    network = wb.ForceNetwork(path, grid(12, 1.0))
    with pytest.raises(wb.WorkbenchError, match="the skin has 144 points"):
        network.force_N(np.zeros((143, 3)))
    with pytest.raises(wb.WorkbenchError, match=r"0\.478 mm apart, trained at 0\.917"):
        wb.ForceNetwork(path, grid(23, 0.5))
    with pytest.raises(wb.WorkbenchError, match="do not come with the skin"):
        wb.ForceNetwork(path)
    with pytest.raises(wb.WorkbenchError, match="do not say at which E"):
        wb.ForceNetwork(path, grid(12, 1.0), young_MPa=0.2)
    other = write_tiny(tmp_path, tiny(target=Target.DISPLACEMENT))
    with pytest.raises(wb.WorkbenchError, match="predicts displacement"):
        wb.ForceNetwork(other, grid(12, 1.0))


def test_the_network_that_ships_needs_no_skin_but_the_force() -> None:
    """It knows the default finger: its points are there, 42 mm high, and at rest there is none."""
    network = wb.ForceNetwork()
    assert network.needs_force
    assert network.points_mm[:, 2].max() == pytest.approx(42.0, abs=0.01)
    rest = np.zeros_like(network.points_mm)
    with pytest.raises(wb.WorkbenchError, match="wants its force too"):
        network.force_N(rest)
    assert np.abs(network.force_N(rest, rest)).max() == 0.0


def test_each_channel_that_enters_has_its_scale() -> None:
    """Three of the displacement, and three more where the contact solver's force enters."""
    assert tiny().input_scale == (0.5, 0.5, 0.5)
    both = dataclasses.replace(tiny(), force_scale_N=0.25)
    assert both.input_scale == (0.5, 0.5, 0.5, 0.25, 0.25, 0.25)


def test_a_missing_package_is_named(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """By the name that pip knows; a missing module of ours stays a bug with its traceback."""
    error = missing_package(ModuleNotFoundError("no", name="cv2.aruco"))
    assert error is not None and error.package == "opencv-python-headless"
    assert missing_package(ModuleNotFoundError("no", name="sim.gone")) is None

    def presets(options: object, project: object) -> int:
        """Fails."""
        raise ModuleNotFoundError("No module named 'nothere'", name="nothere")

    failing = Command(place=0, run=presets, options=lambda sub: None)
    monkeypatch.setattr(command_line, "commands", lambda: {"presets": failing})
    assert main(["presets"]) == 2
    said = capsys.readouterr().err
    assert "needs the Python package nothere" in said and "pip install nothere" in said


def test_every_package_that_is_imported_can_be_installed_by_the_name_that_is_told() -> None:
    """The name is a dependency, or an extra: what pip would install is what we mean."""
    table = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = [
        line for lines in table["project"]["optional-dependencies"].values() for line in lines
    ]
    lines = [*table["project"]["dependencies"], *extras, *table["dependency-groups"]["dev"]]
    # To pip - and _ are the same letter (PEP 503).
    known = {line.split(">")[0].split("=")[0].replace("_", "-") for line in lines}
    imported: set[str] = set()
    for package in OURS:
        for path in (ROOT / package).rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_bytes())):
                names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
                if isinstance(node, ast.ImportFrom):
                    names = [node.module or ""]
                imported |= {name.partition(".")[0] for name in names}
    foreign = imported - sys.stdlib_module_names - {*OURS, "__future__"}
    assert len(foreign) > 15
    told = {missing_package(ModuleNotFoundError("no", name=name)) for name in foreign}
    assert {error.package.replace("_", "-") for error in told if error is not None} <= known
