"""Designs that somebody else may have made: what they name, and how large they grow."""

from __future__ import annotations

import io
import struct
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from workbench.core.base.errors import DesignError, shown
from workbench.edit.forms import load_design
from workbench.project.design_bundle import unbundle, zipped
from workbench.project.named_designs import load_design as any_design
from workbench.project.project import Project

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
        # A long path is repeated without its middle.
        told.add(said.replace(shown(name), "''"))
        assert str(tmp_path) not in said.replace(shown(name), "")
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


def packed(method: int, size: int, *, declared: int | None = None) -> bytes:
    """A zip whose body is zeros [bytes], and may declare another size."""
    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", method) as archive:
        archive.writestr("d.toml", 'name = "x"\nfamily = "finger"\n')
        archive.writestr("bodies/a.stl", bytes(size))
    data = bytearray(buffer.getvalue())
    if declared is not None:
        local, listed = data.find(b"PK\x03\x04", 4), data.rfind(b"PK\x01\x02")
        data[local + 22 : local + 26] = struct.pack("<I", declared)
        data[listed + 24 : listed + 28] = struct.pack("<I", declared)
    return bytes(data)


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_a_zip_that_lies_about_its_size_takes_no_memory(method: int, tmp_path: Path) -> None:
    """60 MB that call themselves 10 bytes are refused within 10 MB."""
    content = packed(method, 60_000_000, declared=10)
    tracemalloc.start()
    with pytest.raises(DesignError, match="not a zip that can be read"):
        unbundle("d.zip", content, Project(tmp_path))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 10_000_000


@pytest.mark.parametrize("method", [zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_every_broken_zip_is_told(method: int, tmp_path: Path) -> None:
    """Each byte of a zip turned over: it is read all the same, or a DesignError says why not."""
    content = packed(method, 50)
    told = []
    for place in range(4, len(content)):
        broken = bytearray(content)
        broken[place] ^= 0x55
        try:
            unbundle("d.zip", bytes(broken), Project(tmp_path))
        except DesignError as error:
            told.append(error)
    assert told
    assert all(error.message and error.hint for error in told)


def meshed(data: bytes) -> bytes:
    """A zip of a design whose object is the mesh in a file of arrays."""
    text = 'name = "x"\nfamily = "finger"\n[press_case.indenter]\nmesh_key = "a"\n'
    return zipped({"d.toml": text.encode(), "indenters/a.npz": data})


def saved(**arrays: np.ndarray) -> bytes:
    """Arrays as a file."""
    buffer = io.BytesIO()
    np.savez_compressed(buffer, allow_pickle=False, **arrays)
    return buffer.getvalue()


def boasting() -> bytes:
    """An array file of some bytes whose header says 240 GB."""
    buffer = io.BytesIO()
    head = {"descr": "<f8", "fortran_order": False, "shape": (10**10, 3)}
    np.lib.format.write_array_header_1_0(buffer, head)
    return zipped({"points_mm.npy": buffer.getvalue(), "faces.npy": buffer.getvalue()})


POINTS, FACE = np.zeros((3, 3)), np.array([[0, 1, 2]], dtype=np.int32)
BAD_ARRAYS = {
    "too large": lambda: saved(points_mm=np.zeros((9_000_000, 3)), faces=FACE),
    "boasting": boasting,
    "texts": lambda: saved(points_mm=np.array([["a", "b", "c"]]), faces=FACE),
    "no such point": lambda: saved(points_mm=POINTS, faces=FACE + 7),
    "no number": lambda: saved(points_mm=POINTS * np.nan, faces=FACE),
    "half triangles": lambda: saved(points_mm=POINTS, faces=FACE + 0.5),
    "other names": lambda: saved(points=POINTS, faces=FACE),
    "no zip": lambda: b"PK",
    "no array": lambda: zipped({"points_mm.npy": b"", "faces.npy": b"x"}),
}


@pytest.mark.parametrize("make", BAD_ARRAYS.values(), ids=BAD_ARRAYS)
def test_arrays_that_are_none_are_told(make: Callable[[], bytes], tmp_path: Path) -> None:
    """What is not a mesh is refused before the memory it asks for is taken."""
    content = meshed(make())
    tracemalloc.start()
    with pytest.raises(DesignError):
        unbundle("d.zip", content, Project(tmp_path))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20_000_000
