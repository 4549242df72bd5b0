"""Damaged files end in a message that names them, never in a signal or a bug."""

# OCP has no type stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import signal
import struct
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

from geometry.intake import cad_file
from geometry.intake.intake import read_body
from geometry.objects.indenters import load_mesh
from workbench.core.base.errors import Cancelled, DesignError, WorkbenchError
from workbench.core.base.monitor import Monitor, silent
from workbench.core.design.imported import ImportedBody, body_file
from workbench.edit.indenter_choice import of_mesh

BALL = trimesh.creation.icosphere(3, 15.0)


def ball_as(kind: str) -> bytes:
    """The ball as a file of a kind."""
    made: Any = BALL.export(file_type=kind)
    return made.encode() if isinstance(made, str) else bytes(made)


@pytest.fixture(scope="module")
def step(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """A rounded box with a ball and a bore: planes, cylinders, spheres and their seams."""
    from build123d import Box, Cylinder, Pos, Sphere, export_step, fillet

    box = Box(20, 20, 30)
    body = fillet(box.edges(), 3) + Pos(0, 0, 15) * Sphere(9) - Pos(5, 0, 0) * Cylinder(2, 60)
    path = tmp_path_factory.mktemp("step") / "body.step"
    export_step(body, str(path))
    return path.read_bytes()


def scribbled(data: bytes, rng: np.random.Generator) -> bytes:
    """Up to forty printable characters replaced."""
    raw = bytearray(data)
    for place in rng.integers(0, len(raw), rng.integers(1, 40)):
        raw[place] = rng.integers(32, 127)
    return bytes(raw)


def flipped(data: bytes, rng: np.random.Generator) -> bytes:
    """Up to forty bits flipped."""
    raw = bytearray(data)
    for place in rng.integers(0, len(raw), rng.integers(1, 40)):
        raw[place] ^= 1 << int(rng.integers(0, 8))
    return bytes(raw)


def truncated(data: bytes, rng: np.random.Generator) -> bytes:
    """The beginning only."""
    return data[: rng.integers(10, len(data))]


def noise(data: bytes, rng: np.random.Generator) -> bytes:
    """Nothing of the file."""
    return rng.bytes(2000)


DAMAGES = (scribbled, flipped, truncated, noise)


def read(name: str, data: bytes, monitor: Monitor = silent) -> None:
    read_body(ImportedBody(outer=body_file(name, data)), monitor)


@pytest.mark.parametrize("damage", DAMAGES, ids=lambda damage: damage.__name__)
@pytest.mark.parametrize("seed", [1, 2])
def test_a_damaged_step_is_refused_by_name(
    step: bytes, damage: Callable[[bytes, np.random.Generator], bytes], seed: int
) -> None:
    """Half of these end the CAD kernel with signal 11; whoever reads them lives on."""
    try:
        read("bone.step", damage(step, np.random.default_rng(seed)))
    except DesignError as error:
        assert error.message.startswith("bone.step ")
        assert error.hint
        assert error.at == "body.outer"


def test_a_kernel_that_dies_or_hangs_is_a_message(
    step: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The child's signal, and the time that it was given, are told with a remedy."""
    raw = scribbled(step, np.random.default_rng(1))
    with pytest.raises(DesignError, match=r"^bone.step cannot be read") as caught:
        read("bone.step", raw)
    assert "export the body again" in caught.value.hint
    monkeypatch.setattr(cad_file, "LIMIT_S", 0.5)
    monkeypatch.setattr(cad_file, "LIMIT_S_PER_MB", 0.0)
    with pytest.raises(DesignError, match=r"^bone.step cannot be read: .* more than"):
        read("bone.step", step)


def test_a_kernel_that_spins_is_ended_within_seconds() -> None:
    """The processor's time counts, so that it is 10 s on a quiet machine and no less on a busy one;
    one that only waits has some times as long.
    """
    spin = "from geometry.intake.cad_child import _confine; _confine(0.3)\nwhile True: pass"
    ended = subprocess.run([sys.executable, "-c", spin], timeout=30, check=False)
    assert ended.returncode == -signal.SIGPROF
    wait = (
        "from geometry.intake.cad_child import _confine; _confine(0.3)\nimport time; time.sleep(60)"
    )
    ended = subprocess.run([sys.executable, "-c", wait], timeout=30, check=False)
    assert ended.returncode == -signal.SIGALRM
    assert cad_file.LIMIT_S < 8.0


def test_reading_a_step_can_be_cancelled(step: bytes) -> None:
    """The monitor's `Cancelled` ends the child and comes through."""

    def stop(fraction: float, note: str = "") -> None:
        raise Cancelled("stop")

    with pytest.raises(Cancelled):
        read("bone.step", step, stop)


def test_a_damaged_step_as_an_object_is_refused_by_name(step: bytes, tmp_path: Path) -> None:
    """Objects take the same way as bodies; the message stands at their own field."""
    path = tmp_path / "tool.step"
    path.write_bytes(scribbled(step, np.random.default_rng(1)))
    with pytest.raises(DesignError, match=r"^tool.step cannot be read") as caught:
        load_mesh(path)
    assert caught.value.at == "indenter"


def test_a_header_of_four_billion_triangles_allocates_nothing(tmp_path: Path) -> None:
    """The count is believed only where the file is as long as it says."""
    whole = ball_as("stl")
    data = whole[:80] + struct.pack("<I", 0xFFFFFFFF) + whole[84:]
    with pytest.raises(DesignError, match=r"big.stl is not an STL file"):
        read("big.stl", data)
    path = tmp_path / "big.stl"
    path.write_bytes(data)
    with pytest.raises(DesignError, match=r"big.stl is not an STL file"):
        load_mesh(path)


def test_a_vertex_far_out_is_named() -> None:
    """One flipped bit of an exponent: the place is told, not that the body has no faces."""
    data = bytearray(ball_as("stl"))
    data[84 + 50 * 7 + 12 : 84 + 50 * 7 + 16] = struct.pack("<f", 3e30)
    with pytest.raises(DesignError, match=r"ball.stl has a vertex at \(3e\+30, .*damaged"):
        read("ball.stl", bytes(data))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("kind", ["stl", "stl_ascii", "obj"])
def test_damaged_meshes_end_in_messages(tmp_path: Path, kind: str) -> None:
    """Twelve files of each format: read, or refused; anything else is a bug."""
    data = ball_as(kind)
    rng = np.random.default_rng(3)
    path = tmp_path / f"ball.{kind[:3]}"
    for turn in range(12):
        path.write_bytes(DAMAGES[turn % 3](data, rng))
        for attempt in (
            lambda: of_mesh(load_mesh(path)),
            lambda: read(path.name, path.read_bytes()) if kind != "obj" else None,
        ):
            try:
                attempt()
            except WorkbenchError as error:
                assert path.name in error.message or error.at == "indenter.size_mm"


def test_a_number_of_fifty_digits_in_an_obj_is_refused(tmp_path: Path) -> None:
    """It does not fit a vertex number of this machine."""
    path = tmp_path / "ball.obj"
    path.write_text(f"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 {'9' * 50}\n")
    with pytest.raises(DesignError, match=r"ball.obj is not an OBJ file"):
        load_mesh(path)


def test_a_coordinate_beyond_a_kilometre_is_refused(
    step: bytes, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A flipped bit of an exponent: 1e308 mm cost 19 GB before the system ended the command."""
    from geometry.intake import intake

    found = cad_file.read_cad(body_file("body.step", step))
    found.points_mm[7] = 1e308
    monkeypatch.setattr(intake, "read_cad", lambda file, monitor: found)
    with pytest.raises(DesignError, match=r"body.step has a vertex at 1e\+308 mm"):
        read_body(ImportedBody(outer=body_file("body.step", step)))
