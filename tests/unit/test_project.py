"""Designs as TOML: the same design comes back; what is wrong is named."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from workbench.core.base.errors import DesignError, StoreError
from workbench.project.design_toml import design_from_toml, design_to_toml
from workbench.project.named_designs import load_design, presets
from workbench.project.project import Project
from workbench.system.whole_files import write_atomically


@pytest.mark.parametrize("name", [*presets(), "finger"])
def test_toml_round_trip(name: str) -> None:
    """design_from_toml(design_to_toml(d)) == d for every preset."""
    design = load_design(name)
    assert design_from_toml(design_to_toml(design)) == design


BAD = {
    "newer schema": ("schema = 99", "schema", "99"),
    "no schema number": ("schema = 'x'", "schema", "'x'"),
    "broken": ("name = ", "design", "not valid TOML"),
    "unknown field": ("nmae = 'x'", "nmae", "nmae"),
    "unknown nested field": ("[layers]\nelastomr_mm = 2.0", "layers.elastomr_mm", "elastomr_mm"),
    "wrong type": ("[layers]\nelastomer_mm = 'thick'", "layers.elastomer_mm", "'thick'"),
    "not a table": ("layers = 3", "layers", "3"),
    "shape is no table": ("shape = 3", "shape", "expected a table"),
    "huge number": ("[layers]\nelastomer_mm = 1" + "0" * 400, "layers.elastomer_mm", "401 digits"),
    "camera nowhere": (
        "[optics.camera]\nposition_mm = [0.0, nan, 0.0]",
        "optics.camera.position_mm",
        "not a finite number",
    ),
    "unknown family": ("family = 'hand'", "family", "'hand'"),
    "unknown shape": ("[shape]\nlength = 3", "shape.length", "length"),
    "shape out of range": ("[shape]\nouter_radius_mm = 500", "shape.outer_radius_mm", "500"),
    "wall thicker than radius": (
        "[shape]\nouter_radius_mm = 6.0\n[layers]\nelastomer_mm = 8.0",
        "layers.elastomer_mm",
        "8 mm",
    ),
    "wrong lens": ("[optics.camera]\nlens = 'wide'", "optics.camera.lens", "'wide'"),
    "two numbers": (
        "[optics.camera]\nposition_mm = [0, 1]",
        "optics.camera.position_mm",
        "3 values",
    ),
    "true as number": ("[optics.ring]\ncount = true", "optics.ring.count", "True"),
}


@pytest.mark.parametrize(("text", "at", "words"), BAD.values(), ids=BAD)
def test_bad_file_is_explained(text: str, at: str, words: str) -> None:
    """Exit code 2, the field, the value and a remedy."""
    with pytest.raises(DesignError) as caught:
        design_from_toml(text)
    assert caught.value.at == at
    assert words in caught.value.message
    assert caught.value.hint
    assert caught.value.exit_code == 2


def test_unknown_preset_suggests_the_nearest() -> None:
    """`gelti` hints at geltip."""
    with pytest.raises(DesignError) as caught:
        load_design("gelti")
    assert "geltip" in caught.value.hint


@pytest.mark.parametrize("name", ["../x", "a/b", "", ".hidden", "x" * 99, "a\0b"])
def test_design_names_cannot_leave_the_folder(tmp_path: Path, name: str) -> None:
    """A name that is a path is refused."""
    with pytest.raises(DesignError):
        Project(tmp_path).design_path(name)


def test_missing_and_binary_files_are_explained(tmp_path: Path) -> None:
    """A missing file and one that is not text have exit code 2."""
    with pytest.raises(DesignError, match="cannot read"):
        load_design(str(tmp_path / "none.toml"))
    (tmp_path / "bin.toml").write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DesignError, match="cannot read"):
        load_design(str(tmp_path / "bin.toml"))


def test_failed_write_keeps_the_old_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """When the disk is full the previous content stays whole."""
    path = tmp_path / "design.toml"
    write_atomically(path, b"old")

    def full(handle: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("os.fsync", full)
    with pytest.raises(StoreError, match="No space left"):
        write_atomically(path, b"new")
    assert path.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [path]


def test_what_a_killed_writer_left_is_swept_away(tmp_path: Path) -> None:
    """Of designs, variants, versions and results; what a living one writes, and all else, stays."""
    project = Project(tmp_path)
    places = ("designs", "variants", "variants/trash", "designs/previous/a", "store/build")
    for place in places:
        (tmp_path / place).mkdir(parents=True)
        # No process has this number: Linux's largest is 2^22.
        for pid in (99_999_999, os.getpid()):
            (tmp_path / place / f".part-{pid}-0a").write_text("half")
        (tmp_path / place / "kept.toml").write_text("whole")
    (tmp_path / "store" / "build" / ".part-99999999-0a").unlink()
    (tmp_path / "store" / "build" / ".part-99999999-0a").mkdir()
    project.sweep()
    for place in places:
        left = sorted(file.name for file in (tmp_path / place).iterdir() if file.name[0] == ".")
        assert left == [f".part-{os.getpid()}-0a"], place
        assert (tmp_path / place / "kept.toml").exists()
