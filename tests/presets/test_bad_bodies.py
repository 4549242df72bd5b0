"""Bodies that designers bring: what cannot be used is refused with value, place and remedy.

Each file is made here, as a CAD program or a scanner would write it.
"""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

pytestmark = pytest.mark.slow


def capsule(scale: float = 1.0) -> trimesh.Trimesh:
    """A rounded column 40 mm high and 30 mm wide, standing on z = 0, cut flat there."""
    column = trimesh.creation.capsule(height=25.0, radius=15.0, count=[32, 32])
    column = column.slice_plane([0.0, 0.0, -12.5], [0.0, 0.0, 1.0], cap=True)
    column.apply_translation((0.0, 0.0, 12.5))
    column.apply_scale(scale)
    return column


def self_intersecting_step(path: Path) -> None:
    """A solid whose skin is a bow tie swept upward: its faces cut through each other."""
    from build123d import Polyline, Solid, Vector, Wire, export_step
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism

    corners = [(-10, -10, 0), (10, 10, 0), (10, -10, 0), (-10, 10, 0)]
    wire = Wire(Polyline(*corners, close=True).edges())
    face = BRepBuilderAPI_MakeFace(wire.wrapped, True).Face()
    prism = BRepPrimAPI_MakePrism(face, Vector(0, 0, 30).wrapped).Shape()
    assert export_step(Solid(prism), str(path))


def two_bodies(path: Path) -> None:
    """The column and a cube beside it in one file."""
    cube = trimesh.creation.box(extents=(8.0, 8.0, 8.0))
    cube.apply_translation((40.0, 0.0, 4.0))
    trimesh.util.concatenate([capsule(), cube]).export(path)


def open_mesh(path: Path) -> None:
    """The column without a quarter of its skin."""
    column = capsule()
    middle = column.triangles_center
    column.update_faces(~((middle[:, 0] > 2.0) & (middle[:, 2] > 4.0)))
    column.export(path)


def in_inches(path: Path) -> None:
    """The column as a CAD program set to inches writes it: 1.57 units high, no unit in the file."""
    capsule(1.0 / 25.4).export(path)


REFUSED: dict[str, tuple[Callable[[Path], None], tuple[str, ...], str]] = {
    "folded.step": (
        self_intersecting_step,
        ("folded.step ",),
        "body.outer",
    ),
    "two.stl": (two_bodies, ("two.stl holds 2 bodies", "512"), "body.outer"),
    "open.stl": (
        open_mesh,
        ("open.stl is open: a hole", "larger than 5 %"),
        "body.outer",
    ),
    "inches.stl": (in_inches, ("is 1.57 units long", "cm: 15.7 mm", "inch: 40 mm"), "body.unit"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_an_unusable_body_is_refused(workbench: Any, tmp_path: Path, name: str) -> None:
    """Exit 2; one message with what was found, its field and what to do; nothing is written."""
    write, words, at = REFUSED[name]
    write(tmp_path / name)
    done = workbench("run", tmp_path / name, "--frames", 1, "--out", tmp_path / "out")
    assert done.code == 2, done.stderr
    assert "Traceback" not in done.stderr
    error = done.lines[-1]
    assert error["error"] == "DesignError"
    for word in words:
        assert word in error["message"]
    assert error["at"] == at
    assert error["hint"]
    assert f"error: {error['message']}" in done.stderr
    assert not list((tmp_path / "out").glob("*"))


@pytest.mark.parametrize("role", ["design", "object"])
def test_a_damaged_step_names_itself(workbench: Any, tmp_path: Path, role: str) -> None:
    """As body and as object: exit 2 and the file's name, whatever became of the CAD kernel."""
    from build123d import Box, export_step, fillet

    box = Box(20, 20, 30)
    path = tmp_path / "bone.step"
    export_step(fillet(box.edges(), 3), str(path))
    raw = bytearray(path.read_bytes())
    rng = np.random.default_rng(1)
    for place in rng.integers(len(raw) // 3, len(raw), 60):
        raw[place] = rng.integers(32, 127)
    path.write_bytes(raw)
    out = tmp_path / "out"
    words = ("run", path) if role == "design" else ("run", "finger", "--indenter", path)
    done = workbench(*words, "--frames", 1, "--out", out)
    assert done.code == 2, done.stderr
    assert "bone.step" in done.lines[-1]["message"]
    assert done.lines[-1]["hint"]
    assert not list(out.glob("*"))


def test_a_file_in_inches_is_right_once_told(workbench: Any, tmp_path: Path) -> None:
    """`--unit inch`: the membrane is 40 mm high and 30 mm wide."""
    in_inches(tmp_path / "inches.stl")
    # The membrane is the body's own skin, whatever the cells of its mesh.
    words = ("--unit", "inch", "--set", "meshing.hex_mm=1.0", "--out", tmp_path / "out")
    done = workbench("export", tmp_path / "inches.stl", *words)
    assert done.code == 0, done.stderr
    membrane = trimesh.load_mesh(tmp_path / "out" / "membrane.stl")
    # A polygon of 32 sides is 0.5 % narrower than its circle across the flats.
    np.testing.assert_allclose(np.ptp(membrane.vertices, axis=0), [30.0, 30.0, 40.0], rtol=5e-3)


def test_what_was_inferred_stands_in_the_summary(workbench: Any, tmp_path: Path) -> None:
    """0.04 units long can only be metres; a doubled triangle is dropped: exit 0, both are said."""
    column = capsule(1.0 / 1000.0)
    column.faces = np.vstack([column.faces, column.faces[:1]])
    column.export(tmp_path / "metres.stl")
    # Neither light, image nor the fineness of the skin matters to what is said.
    words = "--depth-mm 0.5 --frames 1 --grid-mm 1.0 --light-model direct".split()
    for field in (
        "meshing.hex_mm=1.0",
        "optics.camera.width_px=160",
        "optics.camera.height_px=120",
    ):
        words += ["--set", field]
    words += ["--out"]
    done = workbench("run", tmp_path / "metres.stl", *words, tmp_path / "out")
    assert done.code == 0, done.stderr
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert "its numbers were taken as m" in summary["notices"]["build"]
    assert "1 doubled triangles were removed" in summary["notices"]["build"]
    assert summary["contact"]["normal_N"] > 0.0
