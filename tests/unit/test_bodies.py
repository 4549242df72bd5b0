"""A design with a body of its own survives its file, a move, and says what it misses."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from geometry.workshop.export import stl_bytes
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Layers, SensorDesign, check_body
from workbench.core.design.imported import FileKind, LengthUnit, Pick
from workbench.core.press.press_case import PressCase
from workbench.pipeline.building import build_solid
from workbench.planning.plan import plan
from workbench.project.aim import default_target_mm
from workbench.project.bodies import read_body_table
from workbench.project.design_toml import design_from_toml, design_to_toml
from workbench.project.named_designs import load_design
from workbench.project.project import Project

DATA = stl_bytes(
    np.array([[0.0, 0, 0], [9, 0, 0], [0, 9, 0], [0, 0, 9]]),
    np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]]),
)


@pytest.fixture
def stl(tmp_path: Path) -> Path:
    path = tmp_path / "wrist.STL"
    path.write_bytes(DATA)
    return path


def test_a_file_is_a_design(stl: Path) -> None:
    """Its name, the family `imported`, the unit asked for; the content by hash."""
    design = load_design(str(stl), unit="inch")
    assert (design.name, design.family) == ("wrist", "imported")
    assert design.body is not None
    assert design.body.unit is LengthUnit.INCH
    assert design.body.outer.kind is FileKind.STL
    assert design.body.outer.data.tobytes() == DATA


def test_saved_designs_keep_their_body_and_travel(stl: Path, tmp_path: Path) -> None:
    """Saved, the project moved, the original deleted: the same design is read again."""
    text = 'schema = 1\nname = "w"\nfamily = "imported"\n[body]\nouter = "wrist.STL"\n'
    text += 'inner = "wrist.STL"\npicks = [{patch = 2, region = "actuator_0"}]\n'
    design = design_from_toml(text, source="w", roots=(tmp_path,))
    project = Project(tmp_path / "project")
    project.save_design("w", design)
    assert len(list((project.folder / "bodies").iterdir())) == 1
    stl.unlink()
    moved = tmp_path / "elsewhere"
    project.folder.rename(moved)
    again = load_design(str(moved / "designs" / "w.toml"))
    assert again == design
    assert again.body is not None
    assert again.body.picks == (Pick(patch=2, region="actuator_0"),)
    assert again.body.outer.name == "wrist.STL"
    assert design_to_toml(again) == design_to_toml(design)


def test_a_design_file_finds_its_body_in_the_project(stl: Path, tmp_path: Path) -> None:
    """Downloaded to another folder, as long as the project keeps the body."""
    project = Project(tmp_path / "project")
    design = load_design(str(stl))
    project.keep_files(design)
    path = tmp_path / "downloads" / "w.toml"
    path.parent.mkdir()
    path.write_text(design_to_toml(design))
    assert load_design(str(path), project=project) == design
    with pytest.raises(DesignError, match="there is no file"):
        load_design(str(path))


def test_an_unknown_silicone_is_refused_with_the_design() -> None:
    """Not first when parts are made: a browser would start with a list that lacks it."""
    text = 'schema = 1\nname = "x"\nfamily = "finger"\n[casting]\nsilicone = "nope"\n'
    with pytest.raises(DesignError, match="no silicone 'nope'"):
        design_from_toml(text)


@pytest.mark.parametrize(
    ("table", "at", "says"),
    [
        ({"outer": "gone.stl"}, "body.outer", "there is no file 'gone.stl'"),
        ({"outer": ""}, "body.outer", "expected the path"),
        ({"outer": 3}, "body.outer", "expected the path"),
        ({}, "body.outer", "expected a table"),
        ("wrist.STL", "body.outer", "expected a table"),
        ({"outer": "wrist.STL", "unit": "mile"}, "body.unit", "mile"),
        ({"outer": "wrist.STL", "unit": ["mm"]}, "body.unit", "mm"),
        ({"outer": "wrist.STL", "picks": 3}, "body.picks", "expected a list"),
        ({"outer": "x" * 5000}, "body.outer", "cannot read x"),
        ({"outer": "wrist.STL\0"}, "body.outer", "wrist"),
        ({"outer": "wrist.STL", "wall": 2}, "body.wall", "no field"),
        ({"outer": "wrist.STL", "inner": "gone.step"}, "body.inner", "gone.step"),
        ({"outer": "wrist.STL", "picks": [{"patch": 1}]}, "body.picks", "region"),
        ({"outer": "wrist.STL", "picks": [{"patch": 1, "region": "top"}]}, "body.picks", "top"),
    ],
)
def test_bad_tables_are_refused(stl: Path, table: object, at: str, says: str) -> None:
    """Each with its place and a remedy."""
    with pytest.raises(DesignError, match=says) as caught:
        read_body_table(table, roots=(stl.parent,))
    assert (caught.value.at or "").startswith(at)
    assert caught.value.hint


def test_large_files_are_refused(tmp_path: Path) -> None:
    """65 MB, one more than allowed; the message has both numbers."""
    path = tmp_path / "scan.stl"
    with path.open("wb") as file:
        file.truncate(65_000_000)
    with pytest.raises(DesignError, match="65 MB, more than 64 MB"):
        load_design(str(path))


def test_an_imported_design_needs_its_file() -> None:
    """Checked before anything runs, by the plan and by the family itself."""
    design = SensorDesign(name="x", family="imported")
    for refused in (check_body, lambda d: plan(d, PressCase())):
        with pytest.raises(DesignError, match="needs the file of its body"):
            refused(design)
    from designs.family import family, resolve_shape

    with pytest.raises(DesignError, match="no body file"):
        build_solid(family("imported"), resolve_shape("imported", {}), Layers())


def test_only_imported_designs_are_read_first(stl: Path) -> None:
    """`intake` comes first for a file and is missing for a finger; picks do not re-read it."""
    design = load_design(str(stl))
    calls = plan(design, PressCase())
    assert next(iter(calls)) == "intake"
    assert "intake" not in plan(load_design("finger"), PressCase())
    assert design.body is not None
    picked = dataclasses.replace(design.body, picks=(Pick(patch=0, region="actuator_0"),))
    other = plan(dataclasses.replace(design, body=picked), PressCase())
    assert other["intake"] == calls["intake"]
    assert other["build"] != calls["build"]


def test_first_press_is_where_the_family_says() -> None:
    """The finger's at (0, 10, 35); the pad's in the middle of its gel."""
    assert default_target_mm(load_design("finger")) == (0.0, 10.0, 35.0)
    x, y, z = default_target_mm(load_design("pad"))
    assert (x, y) == (0.0, 0.0)
    assert z > 10.0
