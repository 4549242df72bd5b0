"""`workbench read`: what is refused at once, and the files of a reading."""

from __future__ import annotations

import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim.reading.maps import PixelMaps
from sim.reading.reader import Touch
from sim.reading.sight import Sight
from workbench.cli.command_line import main
from workbench.core.base.errors import DesignError
from workbench.reading.design_reader import expect_light
from workbench.reading.outputs import names_of, write_reading, write_table
from workbench.reading.read_photo import Reading
from workbench.report.image_files import png_bytes


def photo(path: Path, rows: int, columns: int) -> Path:
    """A grey photograph."""
    path.write_bytes(png_bytes(np.full((rows, columns, 3), 90, dtype=np.uint8)))
    return path


def read(tmp_path: Path, *words: str) -> int:
    return main(["read", "--project", str(tmp_path / "p"), "pad", *words, "--out", str(tmp_path)])


def test_photographs_of_another_size_are_refused_at_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With both sizes, before anything is built."""
    idle, press = photo(tmp_path / "idle.png", 30, 40), photo(tmp_path / "a.png", 30, 40)
    assert read(tmp_path, str(press), "--idle", str(idle)) == 2
    told = capsys.readouterr().err
    assert "40 x 30 pixels" in told
    assert "640 x 480" in told
    assert not list((tmp_path / "p").rglob("*.npz"))


def test_a_missing_photograph_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The idle one, or another."""
    press = photo(tmp_path / "a.png", 480, 640)
    assert read(tmp_path, str(press), "--idle", str(tmp_path / "none.png")) == 2
    assert "none.png" in capsys.readouterr().err
    with pytest.raises(SystemExit) as stopped:
        read(tmp_path, str(press))
    assert stopped.value.code == 2
    assert "--idle" in capsys.readouterr().err


def test_a_saturated_photograph_is_refused() -> None:
    """With its share; a few white pixels are left out instead."""
    image = np.full((10, 10, 3), 90, dtype=np.uint8)
    image[:6, :, 1] = 255
    with pytest.raises(DesignError, match="saturated at 60 %"):
        expect_light("a.png", image, np.ones(100, dtype=bool))
    expect_light("a.png", image, np.arange(100) >= 50)


def test_files_of_photographs_with_the_same_name_differ() -> None:
    """Numbered from the second on."""
    paths = [Path("x/a.png"), Path("y/a.jpg"), Path("b.png"), Path("z/a.png")]
    assert names_of(paths) == ["a", "a_2", "b", "a_3"]


def test_the_files_of_a_reading_say_what_is_known(tmp_path: Path) -> None:
    """Arrays as promised; what is not known is null in the table."""
    found = reading(force_N=np.full(3, np.nan))
    write_reading(tmp_path, "a", found)
    write_table(tmp_path, [found.figures])
    with np.load(tmp_path / "a.npz") as file:
        shapes = {name: file[name].shape for name in file.files}
    assert shapes["depth_mm"] == shapes["sigma_mm"] == shapes["contact"] == (6, 8)
    assert shapes["normal"] == (6, 8, 3)
    assert shapes["surface_displacement_mm"] == (5,)
    assert shapes["force_N"] == (3,)
    assert (tmp_path / "a_depth.png").read_bytes()[:4] == b"\x89PNG"
    (row,) = json.loads((tmp_path / "reading.json").read_text())
    assert row["photo"] == "a.png"
    assert row["peak_depth_mm"] == pytest.approx(0.4)
    assert row["ball_radius_mm"] is None
    assert row["force_N"] == [None, None, None]


def reading(**values: Any) -> Reading:
    """A reading of 6 x 8 pixels and 5 vertices."""
    depth_mm = np.full((6, 8), np.nan, dtype=np.float32)
    depth_mm[2:4] = 0.3
    given = SimpleNamespace(
        photo="a.png",
        touch=Touch(
            inward_mm=np.linspace(0.0, 0.4, 5),
            sigma_mm=np.full(5, 0.01),
            misfit=1.0,
            noise_grey=1.0,
            steps=5,
            seconds=0.2,
            sight=Sight(face=np.zeros(48), weights=np.zeros((48, 3)), light=np.zeros((48, 3))),
        ),
        normals=np.tile([0.0, 0.0, 1.0], (5, 1)),
        maps=PixelMaps(
            depth_mm=depth_mm,
            normal=np.zeros((6, 8, 3), dtype=np.float32),
            contact=depth_mm > 0.1,
            sigma_mm=depth_mm,
        ),
        force_N=np.array([0.0, 0.0, -0.2]),
        force_sigma_N=0.03,
        contact_area_mm2=4.0,
        ball_radius_mm=float("nan"),
    )
    return Reading(**{**vars(given), **values})
