"""Designs that somebody else may have made: what they name, and how large they grow."""

from __future__ import annotations

from pathlib import Path

import pytest

from workbench.core.errors import DesignError
from workbench.design_bundle import unbundle, zipped
from workbench.forms import load_design
from workbench.project import Project
from workbench.project import load_design as any_design

BODY = 'name = "x"\nfamily = "imported"\n[body]\nouter = "{}"\nouter_name = "x.stl"\n'
PICTURE = 'name = "x"\nfamily = "finger"\n[optics]\nbackground = "{}"\n'


@pytest.mark.parametrize("table", [BODY, PICTURE])
@pytest.mark.parametrize("packed", [True, False])
def test_a_loaded_design_names_no_file_outside(table: str, packed: bool, tmp_path: Path) -> None:
    """Absolute, climbing and through a link: told alike, whether or not the file exists."""
    project = Project(tmp_path / "project")
    project.folder.mkdir()
    secret = tmp_path / "secret.stl"
    secret.write_bytes(b"4711")
    (project.folder / "link.stl").symlink_to(secret)
    told = set()
    back_in = f"../project/{secret.name}"
    (project.folder / secret.name).write_bytes(b"own")
    for name in (str(secret), "../secret.stl", "../none.stl", "link.stl", back_in):
        text = table.format(name).encode()
        content = zipped({"d.toml": text}) if packed else text
        with pytest.raises(DesignError, match="there is no") as caught:
            unbundle("d", content, project)
        said = f"{caught.value.message} {caught.value.hint}"
        told.add(said.replace(name, ""))
        assert str(tmp_path) not in said.replace(name, "")
    assert len(told) == 1


def test_a_design_of_the_command_line_still_names_any_file(tmp_path: Path) -> None:
    """Beside it, or anywhere by its absolute path."""
    (tmp_path / "x.stl").write_bytes(b"solid")
    (tmp_path / "d.toml").write_text(BODY.format(tmp_path / "x.stl"))
    design = any_design(str(tmp_path / "d.toml"))
    assert design.body is not None and design.body.outer.name == "x.stl"


def test_what_a_page_sends_as_a_start_is_no_path(tmp_path: Path) -> None:
    """The list of starts takes the names that it offers, and no file."""
    (tmp_path / "x.stl").write_bytes(b"solid")
    with pytest.raises(DesignError, match="cannot start from"):
        load_design(str(tmp_path / "x.stl"))
    assert load_design("finger").family == "finger"
