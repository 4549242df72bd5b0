"""The examples of docs/extending.md: each saved as it stands in a folder of its own, and used."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parent.parent
PAGE = ROOT / "docs" / "extending.md"
FILES = dict(re.findall(r"^```python\n# (\S+)\n(.*?)^```$", PAGE.read_text(), re.M | re.S))
ASK = """
import json
from sim.optics.field.model import model_of, models
from sim.optics.maps.map_kind import map_kinds
from workbench.cli.command_line import parser
from workbench.core.press.indenter import Indenter
from workbench.edit.indenter_edit import gallery
from workbench.live.indenter_display import display_mesh
from workbench.planning.stage_table import STAGES
from workbench.view.metric_rules import RULES
from ui.panels.page import pages
from geometry.surface.surface import is_watertight, mesh_volume
points, faces = display_mesh(Indenter("egg", size_mm=6.0))
help = parser().format_help()
print(json.dumps({
    "gallery": list(gallery().values()),
    "models": {name.value: model.hint for name, model in models().items()},
    "maps": {name: kind.label for name, kind in map_kinds().items()},
    "rules": list(RULES),
    "stages": {name: stage.label for name, stage in STAGES.items()},
    "help": help,
    "pages": {label: found.help for label, found in pages().items()},
    "egg": [bool(is_watertight(faces)), float(mesh_volume(points, faces))],
}))
"""
USE = """
import json, sys
import workbench as wb
design = wb.load("pad").replace("optics.light_model", "unshadowed")
design = design.replace("meshing.hex_mm", 1.0).replace("optics.camera.width_px", 160)
design = design.replace("optics.camera.height_px", 120)
press = wb.Press(depth_mm=0.5, frames=1)
settings = wb.ContactSettings(grid_mm=1.0)
found = wb.evaluate(design, wb.Indenter("egg"), press, settings=settings, project=sys.argv[1])
print(json.dumps({
    "secant": found["stiffness"].values["secant_N_per_mm"],
    "force": float(found.contact.normal_N[-1]),
    "figure": found["shoot"].metrics.values["lit_by_median_1"],
    "light": float(found.images[-1].max()),
}))
"""


@pytest.fixture(scope="module")
def extended(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """The environment of somebody who saved all the examples."""
    folder = tmp_path_factory.mktemp("mine")
    for name, text in FILES.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    # Taichi prints a line as it is imported, before what is asked.
    quiet = {"ENABLE_TAICHI_HEADER_PRINT": "0"}
    return {**os.environ, **quiet, "WORKBENCH_EXTENSIONS": str(folder)}


def answer(environment: dict[str, str], *words: str) -> str:
    """What Python prints with the examples there."""
    done = subprocess.run(
        [sys.executable, *words],
        env=environment,
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_each_noun_has_its_example() -> None:
    """One file for each row of the table but the family, which has a page of its own."""
    packages = re.findall(r"^\| [a-z ]+ \| `(\S+)/` \| `[A-Z]+` \|", PAGE.read_text(), re.M)
    folders = [name.replace("/weight/page.py", "/page.py") for name in FILES]
    assert [f"{Path(name).parent}" for name in folders] == packages[1:]


def test_a_file_is_all_that_a_noun_needs(extended: dict[str, str]) -> None:
    """Gallery, menus, score card, chain and help have it, with the words of its file."""
    found: dict[str, Any] = json.loads(answer(extended, "-c", ASK))
    assert found["gallery"][:17].count("egg") == 1
    assert found["models"]["unshadowed"] == "1/r² without shadows"
    assert found["maps"]["lit_by"] == "LEDs at work"
    assert "lit_by_median_1" in found["rules"]
    assert found["stages"]["stiffness"] == "Stiffness"
    assert "Weigh the membrane of a design." in found["help"]
    pages = list(found["pages"])
    assert pages[pages.index("Read") + 1] == "Weight" and "weighs" in found["pages"]["Weight"]
    closed, volume_mm3 = found["egg"]
    # Half a ball and half an ellipsoid twice as high: 2 pi r^3 (1 + 2) / 3 = 2 pi r^3.
    assert closed and volume_mm3 == pytest.approx(169.6, rel=0.02)


def test_without_the_folder_there_is_none_of_them() -> None:
    """The examples are not part of the program."""
    from sim.optics.field.model import models
    from workbench.planning.stage_table import STAGES

    assert "unshadowed" not in models() and "stiffness" not in STAGES


def test_the_new_command_answers(extended: dict[str, str], tmp_path: Path) -> None:
    """`workbench weigh pad`: its elastomer is 1.07 g/cm3."""
    words = ("-m", "workbench.cli", "weigh", "pad", "--project", str(tmp_path))
    said = answer(extended, *words)
    assert re.fullmatch(r"\d+\.\d\d g\n", said) and float(said.split()[0]) > 0.1


@pytest.mark.slow
def test_the_new_export_is_written(extended: dict[str, str], tmp_path: Path) -> None:
    """`workbench export pad --xyz`: one line for each vertex of a skin 20 mm or so wide."""
    words = ("-m", "workbench.cli", "export", "pad", "--xyz", "--out", str(tmp_path / "out"))
    answer(extended, *words, "--set", "meshing.hex_mm=1", "--project", str(tmp_path))
    places = [line.split() for line in (tmp_path / "out" / "skin.xyz").read_text().splitlines()]
    assert len(places) > 200 and all(len(place) == 3 for place in places)


@pytest.mark.slow
def test_all_of_them_work_together(extended: dict[str, str], tmp_path: Path) -> None:
    """A pad pressed with the egg and lit by the model: force, figure of the map, the stage."""
    found = json.loads(answer(extended, "-c", USE, str(tmp_path)))
    assert found["force"] > 0.05
    assert found["secant"] == pytest.approx(found["force"] / 0.5)
    assert found["figure"] >= 1.0 and found["light"] > 30
