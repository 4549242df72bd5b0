"""Kept designs and designs as one file: nothing is lost, and nonsense is told."""

from __future__ import annotations

import dataclasses
import io
import tomllib
import zipfile
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.project import saved_designs as saved_module
from workbench.project.design_bundle import MOST_FILES, bundle, unbundle, zipped
from workbench.project.named_designs import load_design
from workbench.project.project import Project
from workbench.project.saved_designs import (
    MOST_VERSIONS,
    SavedShelf,
    delete_design,
    open_design,
    restore_design,
    save_named,
    saved_names,
    versions,
)
from workbench.project.state import State, fresh_state


def named(name: str) -> State:
    """A finger of that name."""
    return fresh_state(dataclasses.replace(load_design("finger"), name=name))


def with_mesh(state: State) -> State:
    """The same pressed by a tetrahedron of the designer's own."""
    points = np.array([[0, 0, -2], [2, 0, 1], [-1, 2, 1], [-1, -2, 1]], dtype=np.float64)
    faces = np.array([[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]], dtype=np.int32)
    mesh = IndenterMesh(points_mm=points, faces=faces)
    indenter = Indenter(kind=IndenterKind.MESH, mesh=mesh, size_mm=4.0, edge_radius_mm=0.0)
    return dataclasses.replace(state, case=dataclasses.replace(state.case, indenter=indenter))


def test_a_saved_design_opens_as_it_was(tmp_path: Path) -> None:
    """Design and press come back equal, and the autosave is not among the kept ones."""
    project = Project(tmp_path)
    state = named("my finger")
    save_named(project, state)
    project.save_design("autosave", state.design)
    assert saved_names(project) == ("my finger",)
    assert open_design(project, "my finger") == state


def test_saving_again_keeps_the_version_before(tmp_path: Path) -> None:
    """designs/previous holds what the last save replaced; the same once more adds nothing."""
    project = Project(tmp_path)
    first = named("a")
    save_named(project, first)
    text = (tmp_path / "designs" / "a.toml").read_text()
    thicker = dataclasses.replace(first, design=first.design.replace("layers.elastomer_mm", 3.0))
    save_named(project, thicker)
    save_named(project, thicker)
    assert [file.read_text() for file in versions(project, "a")] == [text]
    assert open_design(project, "a") == thicker


def test_the_newest_versions_are_kept(tmp_path: Path) -> None:
    """After 23 saves the 20 before the last stand there in their order."""
    project, state = Project(tmp_path), named("a")
    walls_mm = [2.0 + 0.1 * k for k in range(MOST_VERSIONS + 3)]
    for wall_mm in walls_mm:
        design = state.design.replace("layers.elastomer_mm", wall_mm)
        save_named(project, dataclasses.replace(state, design=design))
    kept = [tomllib.loads(file.read_text()) for file in versions(project, "a")]
    assert [table["layers"]["elastomer_mm"] for table in kept] == walls_mm[2:-1]


def test_two_deleted_designs_of_one_name_both_come_back(tmp_path: Path) -> None:
    """The trash overwrites nothing, and what comes back gets a number where its name is taken."""
    project, first = Project(tmp_path), named("a")
    second = dataclasses.replace(first, design=first.design.replace("layers.elastomer_mm", 3.0))
    kept = []
    for state in (first, second):
        save_named(project, state)
        kept.append(delete_design(project, "a"))
    assert kept == ["a", "a 2"] and saved_names(project) == ()
    assert restore_design(project, kept[0]) == "a"
    assert open_design(project, "a") == first
    save_named(project, first)
    assert restore_design(project, kept[1]) == "a 2"
    assert open_design(project, "a 2").design.layers.elastomer_mm == 3.0


def test_an_unchanged_design_is_read_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The second list reads no file; one that changed is read again."""
    project = Project(tmp_path)
    for name in ("a", "b"):
        save_named(project, named(name))
    shelf, read = SavedShelf(project), []
    real = saved_module.open_design
    monkeypatch.setattr(
        saved_module, "open_design", lambda where, name: read.append(name) or real(where, name)
    )
    first = shelf.entries()
    assert shelf.entries() == first and all(entry.build for entry in first)
    assert read == ["a", "b"]
    thick = named("a").design.replace("layers.elastomer_mm", 3.25)
    save_named(project, fresh_state(thick))
    assert shelf.entries()[0].build != first[0].build
    assert read == ["a", "b", "a"]


def test_a_huge_file_is_not_read(tmp_path: Path) -> None:
    """2 MB of comment are no design."""
    (tmp_path / "designs").mkdir()
    (tmp_path / "designs" / "big.toml").write_bytes(b"#" * 2_000_000)
    with pytest.raises(DesignError, match="larger than 1000000"):
        open_design(Project(tmp_path), "big")


def test_a_file_edited_into_nonsense_is_listed_with_its_reason(tmp_path: Path) -> None:
    """The others still open; the broken one is told, and can be deleted."""
    project = Project(tmp_path)
    save_named(project, named("good"))
    (tmp_path / "designs" / "bad.toml").write_text("name = = 3")
    (tmp_path / "designs" / "binary.toml").write_bytes(b"\xff\xfe\x00")
    bad, binary, good = SavedShelf(project).entries()
    assert "not valid TOML" in bad.reason and "cannot be read" in binary.reason
    assert good.family == "finger" and not good.reason
    kept = delete_design(project, "bad")
    assert (tmp_path / "designs" / "trash" / f"{kept}.toml").read_text() == "name = = 3"
    assert saved_names(project) == ("binary", "good")


@pytest.mark.parametrize(
    "name", ["../evil", "autosave", "Autosave", "a/b", "", "<b>", "a\nb", "a ", "-", "漢" * 81]
)
def test_a_name_that_leaves_the_folder_is_refused(tmp_path: Path, name: str) -> None:
    """Nothing is written outside designs/, nor over the workbench's own copy."""
    project = Project(tmp_path)
    with pytest.raises(DesignError):
        save_named(project, named(name))
    assert not list(tmp_path.rglob("*.toml"))


def test_a_plain_design_travels_as_readable_toml(tmp_path: Path) -> None:
    """One TOML, which another project reads to the same state."""
    state = named("plain")
    name, content = bundle(state, Project(tmp_path / "a"))
    assert name == "plain.toml" and b"[layers]" in content
    assert unbundle(name, content, Project(tmp_path / "b")) == state


def test_a_design_with_files_travels_as_a_zip(tmp_path: Path) -> None:
    """The indenter's mesh comes with it, and the other project keeps it."""
    state = with_mesh(named("meshed"))
    name, content = bundle(state, Project(tmp_path / "a"))
    assert name == "meshed.zip"
    other = Project(tmp_path / "b")
    found = unbundle(name, content, other)
    assert found.design == state.design
    assert digest(found.case.indenter) == digest(state.case.indenter)
    save_named(other, found)
    again = open_design(other, "meshed")
    assert digest(again.case.indenter) == digest(state.case.indenter)


def test_a_zip_that_does_not_belong_is_refused_and_leaves_nothing(tmp_path: Path) -> None:
    """No TOML, too many files, broken bytes, a path that climbs: told, and nothing is written."""
    project = Project(tmp_path / "p")
    good = bundle(named("x"), project)[1]
    many = {f"pictures/{k}.png": b"" for k in range(MOST_FILES)} | {"x.toml": good}
    for content, words in (
        (zipped({"readme.txt": b"hello"}), "0 TOML files"),
        (zipped(many), "files of"),
        (zipped({"x.toml": good})[:-30], "not a zip"),
    ):
        with pytest.raises(DesignError, match=words):
            unbundle("x.zip", content, project)
    climbing = io.BytesIO()
    with zipfile.ZipFile(climbing, "w") as archive:
        archive.writestr("x.toml", good)
        archive.writestr("bodies/../../evil", b"no")
    unbundle("x.zip", climbing.getvalue(), project)
    assert not list(tmp_path.rglob("evil"))


def test_loading_text_that_is_none_is_told(tmp_path: Path) -> None:
    """Bytes that are no UTF-8 and a file of 2 MB name the limit."""
    project = Project(tmp_path)
    with pytest.raises(DesignError, match="UTF-8"):
        unbundle("x.toml", b"\xff\xff", project)
    with pytest.raises(DesignError, match="at most 1000000"):
        unbundle("x.toml", b"#" * 2_000_000, project)
