"""The learned reader in use: which one belongs to a design, its files, and its life elsewhere."""

from __future__ import annotations

import dataclasses
import json
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim.reading.network.reader_file import ReaderFile, reader_bytes
from sim.reading.network.rest_view import RestView
from sim.reading.network.spec import COLUMNS, ReaderSpec
from tests.made_readers import reader_file
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.core.design.camera import Camera
from workbench.core.design.design import SensorDesign
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.reading import find_reader as find_reader_module
from workbench.reading.export_reader import export_reader
from workbench.reading.find_reader import find_reader, reader_path
from workbench.reading.learned_reader import LearnedReader
from workbench.reading.outputs import write_reading
from workbench.reading.reader_digest import reader_digest
from workbench.report.image_files import png_bytes

CAMERA = Camera(width_px=96, height_px=64)
VERTICES = 5


def mesh() -> Any:
    """A strip of skin with five vertices, seen from below."""
    points = np.column_stack([np.arange(5.0), np.arange(5) % 2, np.zeros(5)])
    faces = np.array([[0, 1, 2], [1, 2, 3], [2, 3, 4]])
    normals = np.tile([0.0, 0.0, 1.0], (5, 1))
    seen = SimpleNamespace(points_mm=points, faces=faces, normals=normals)
    return SimpleNamespace(seen=seen)


def photo(seed: int, camera: Camera = CAMERA) -> np.ndarray:
    """Grey levels at random."""
    size = (camera.height_px, camera.width_px, 3)
    return np.random.default_rng(seed).integers(60, 180, size).astype(np.uint8)


def saying(depth_mm: float, **changes: object) -> ReaderFile:
    """A reader that says one depth everywhere, with a small deviation, whatever it sees."""
    reader = reader_file(**changes)
    arrays = {name: np.zeros_like(array) for name, array in reader.arrays.items()}
    # Channels of the last layer lie four by four: surface, depth, turn (3), touch, pressure, log.
    arrays["maps.bias"][:8] = depth_mm
    arrays["maps.bias"][20:24] = 3.0 if depth_mm > 0.05 else -3.0
    arrays["maps.bias"][28:32] = -9.0
    arrays["shares.2.bias"][2] = 0.1
    return dataclasses.replace(reader, arrays=arrays)


def test_a_reading_has_all_that_the_table_reader_tells(tmp_path: Path) -> None:
    """Maps in the camera's size, vertices where the camera sees them, NaN and 0 where not."""
    found = LearnedReader(saying(0.4), CAMERA, mesh(), photo(0), "cpu").read("a.png", photo(1))
    assert found.maps.depth_mm.shape == (64, 96)
    assert np.isnan(found.maps.depth_mm[:, 0]).all()
    assert np.nanmax(np.abs(found.maps.depth_mm - 0.4)) < 1e-6
    assert found.maps.contact[:, 8:].all()
    assert not found.maps.contact[:, 0].any()
    # exp(-9 / 2)
    assert found.maps.sigma_mm[5, 20] == pytest.approx(0.0111, abs=1e-4)
    assert np.allclose(found.maps.normal[5, 20], [0, 0, 1], atol=0.01)
    # The first vertex is out of sight.
    assert found.surface_mm == pytest.approx([0.0, 0.4, 0.4, 0.4, 0.4])
    assert np.isnan(found.surface_sigma_mm).tolist() == [True] + [False] * 4
    # 2 rows x 3 columns of coarsest places, each a tenth of two newtons.
    assert found.force_N == pytest.approx([0.0, 0.0, 6 * 0.1 * 2.0])
    assert found.figures["peak_depth_mm"] == pytest.approx(0.4)
    # Areas of vertices 1 to 4: 3 triangles of 1 mm2 less the third of one at vertex 0.
    assert found.contact_area_mm2 == pytest.approx(3.0 - 1.0 / 3.0)
    write_reading(tmp_path, "a", found)
    with np.load(tmp_path / "a.npz") as file:
        assert set(file.files) == {
            *("depth_mm", "normal", "contact", "sigma_mm", "pressure_MPa"),
            *("surface_displacement_mm", "surface_sigma_mm", "force_N", "force_sigma_N"),
        }


def test_depths_that_are_not_sure_are_no_contact() -> None:
    """Less than .05 mm, on vertices too: no area, no ball."""
    found = LearnedReader(saying(0.02), CAMERA, mesh(), photo(0), "cpu").read("a.png", photo(1))
    assert found.contact_area_mm2 == 0.0
    assert not found.maps.contact.any()
    assert found.figures["ball_radius_mm"] is None


def test_photographs_of_another_size_are_refused() -> None:
    """By name."""
    reader = LearnedReader(saying(0.4), CAMERA, mesh(), photo(0), "cpu")
    with pytest.raises(DesignError, match=r"b\.png has 40 x 30 pixels"):
        reader.read("b.png", np.zeros((30, 40, 3), np.uint8))


def kept(project: Project, name: str, **changes: object) -> Path:
    """A reader in a project."""
    path = project.folder / "readers" / f"{name}.reader.npz"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(reader_bytes(reader_file(**changes)))
    return path


@pytest.mark.parametrize("name", ["geltip", "pad"])
def test_presets_have_a_reader_that_ships(tmp_path: Path, name: str) -> None:
    """Its digest is that of the preset as it ships today."""
    assert find_reader(load_design(name), Project(tmp_path / "p"), None).design == name


def test_a_reader_is_found_by_what_an_image_depends_on(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Not by names, nor by how the sensor is made; a change of light asks for another."""
    monkeypatch.setattr(find_reader_module, "SHIPPED", tmp_path / "none")
    project, design = Project(tmp_path / "p"), load_design("pad")
    with pytest.raises(DesignError, match="no learned reader knows pad") as none:
        find_reader(design, project, None)
    assert "workbench reader train" in none.value.hint
    kept(project, "mine", design="pad", digest=reader_digest(design))
    assert find_reader(design, project, None).design == "pad"
    for same in (
        dataclasses.replace(design, name="other"),
        design.replace("housing.wall_mm", 2.0),
        design.replace("optics.camera.width_px", 320).replace("optics.camera.height_px", 240),
    ):
        assert find_reader(same, project, None).design == "pad"
    for changed in (
        design.replace("optics.coating.albedo", 0.3),
        design.replace("layers.elastomer_mm", 2.7),
        design.replace("material.young_MPa", 0.3),
        design.replace("optics.camera.height_px", 360),
    ):
        with pytest.raises(DesignError, match="pad has changed in shape, material or optics"):
            find_reader(changed, project, None)


def test_named_weights_must_suit_the_design(tmp_path: Path) -> None:
    """Whatever the project keeps."""
    project, design = Project(tmp_path / "p"), load_design("pad")
    path = kept(project, "x", design="paw")
    with pytest.raises(DesignError, match="was learned for 'paw'"):
        find_reader(design, project, path)


def test_a_reader_of_a_design_has_a_place_in_the_project(tmp_path: Path) -> None:
    """By its name; a name that no file can have gives another."""
    project = Project(tmp_path / "p")
    assert reader_path(SensorDesign(name="mine"), project).name == "mine.reader.npz"
    assert reader_path(SensorDesign(name="a/b"), project).name == "reader.reader.npz"


def test_the_command_says_how_to_train(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Within a moment, before anything is built; weights need the learned reader."""
    idle = tmp_path / "idle.png"
    idle.write_bytes(png_bytes(np.full((480, 640, 3), 90, np.uint8)))
    words = ["read", "--project", str(tmp_path / "p"), "pad", str(idle), "--idle", str(idle)]
    words += ["--out", str(tmp_path / "out"), "--set", "optics.coating.albedo=0.31"]
    assert main([*words, "--reader", "learned"]) == 2
    assert "workbench reader train" in capsys.readouterr().err
    assert main([*words, "--weights", "x.npz"]) == 2
    assert "--reader learned" in capsys.readouterr().err


def exported(tmp_path: Path) -> ReaderFile:
    """An exported reader with pictures beside it."""
    rows, columns = 48, COLUMNS
    rest = RestView.made(
        np.ones((rows, columns), bool), np.ones((rows, columns, 3)), np.full((VERTICES, 2), 9.0)
    )
    spec = ReaderSpec(widths=(8, 8, 12, 12), rows=rows)
    # In ten times the contrast an untrained network says something.
    made = reader_file(spec=spec, rest=rest, camera_px=(640, 96))
    loud = {**made.arrays, "maps.weight": 300.0 * made.arrays["maps.weight"]}
    reader = dataclasses.replace(made, arrays=loud)
    export_reader(reader, tmp_path)
    camera = Camera(width_px=640, height_px=96)
    for name, seed in (("idle", 0), ("press", 1)):
        (tmp_path / f"{name}.png").write_bytes(png_bytes(photo(seed, camera)))
    return reader


ALONE = """
import importlib.abc, runpy, sys
class No(importlib.abc.MetaPathFinder):
    def find_spec(self, name, path=None, target=None):
        if name.split(".")[0] in ("workbench", "sim", "geometry", "designs", "ui", "scipy"):
            raise ImportError(f"{name} is blocked")
sys.meta_path.insert(0, No())
sys.argv = sys.argv[1:]
runpy.run_path(sys.argv[0], run_name="__main__")
"""
"""Runs a script where nothing of ours can be imported."""


def test_an_exported_reader_runs_without_the_workbench(tmp_path: Path) -> None:
    """In a process where importing ours fails it says the product's depth."""
    reader = exported(tmp_path)
    words = [sys.executable, "-c", ALONE, "read.py", "idle.png", "press.png"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("press: ")
    camera = Camera(width_px=640, height_px=96)
    ours = LearnedReader(reader, camera, mesh(), photo(0, camera), "cpu")
    depth_mm = ours.read("press.png", photo(1, camera)).maps.depth_mm
    found = np.load(tmp_path / "press_depth.npy")
    assert np.ptp(depth_mm) > 0.01
    # Float32 in another order of operations.
    assert np.allclose(found, depth_mm, atol=1e-4)


def test_a_script_without_ours_would_fail_with_it(tmp_path: Path) -> None:
    """The block of the test above does block."""
    (tmp_path / "bad.py").write_text("import workbench\n")
    words = [sys.executable, "-c", ALONE, "bad.py"]
    done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.returncode != 0
    assert "workbench is blocked" in done.stderr


def test_the_card_is_readable_json(tmp_path: Path) -> None:
    """Beside the file, with the curves."""
    from workbench.learning.readers.reader_card import write_beside

    rows = [{"minutes": m, "validation_mae_mm": 0.2 / m, "zero_mae_mm": 0.3} for m in (1.0, 2.0)]
    write_beside(tmp_path / "a.reader.npz", {"scores": {"test": 0.1}}, rows)
    assert json.loads((tmp_path / "a-card.json").read_text()) == {"scores": {"test": 0.1}}
    assert (tmp_path / "a-curves.csv").read_text().count("\n") == 3
    assert (tmp_path / "a-curves.png").read_bytes()[:4] == b"\x89PNG"
