"""STL files that cannot be used are refused by name; all kinds have a closed display mesh."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from geometry.objects.indenters import largest_width, load_stl, scaled
from geometry.surface.primitives import rounded_box, sphere
from geometry.surface.surface import is_watertight, mesh_volume
from geometry.workshop.export import stl_bytes
from workbench.core.base.errors import DesignError
from workbench.core.objects.kind import Shape, kind_of
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.live.indenter_display import display_mesh

PRIMITIVES = [kind for kind in IndenterKind if kind_of(kind).shape is not Shape.GRID]


def written(folder: Path, data: bytes) -> Path:
    path = folder / "tool.stl"
    path.write_bytes(data)
    return path


def as_text(points: np.ndarray, faces: np.ndarray) -> bytes:
    lines = ["solid tool"]
    for face in faces:
        lines += ["facet normal 0 0 0", " outer loop"]
        lines += ["  vertex " + " ".join(repr(float(x)) for x in points[i]) for i in face]
        lines += [" endloop", "endfacet"]
    return "\n".join([*lines, "endsolid tool"]).encode()


def test_box_comes_back_centred_and_outward(tmp_path: Path) -> None:
    """An inside-out 2 x 4 x 6 box far away: 48 mm3, from -1, -2, -3 to 1, 2, 3, 8 vertices."""
    points, faces = rounded_box(1.0, 0.0)
    moved = points * [1.0, 2.0, 3.0] + [50.0, -20.0, 7.0]
    for data in (stl_bytes(moved, faces[:, ::-1]), as_text(moved, faces)):
        mesh = load_stl(written(tmp_path, data))
        assert mesh.points_mm.shape == (8, 3)
        assert mesh.points_mm.min(axis=0) == pytest.approx([-1.0, -2.0, -3.0])
        assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(48.0)
        assert mesh.faces.dtype == np.int32
        assert largest_width(mesh) == pytest.approx(6.0)
        assert largest_width(scaled(mesh, 9.0)) == pytest.approx(9.0)


def test_missing_file(tmp_path: Path) -> None:
    """The path is named."""
    with pytest.raises(DesignError, match=r"there is no file .*gone\.stl") as caught:
        load_stl(tmp_path / "gone.stl")
    assert caught.value.at == "indenter"
    with pytest.raises(DesignError, match="there is no file"):
        load_stl(tmp_path)


def test_two_gigabytes_are_refused_unread(tmp_path: Path) -> None:
    """A sparse file of 2 GB: refused by its size, at once."""
    path = tmp_path / "huge.stl"
    with path.open("wb") as file:
        file.truncate(2_000_000_000)
    with pytest.raises(DesignError, match=r"huge\.stl has 2,000 MB, more than 64 MB"):
        load_stl(path)


def bad_files() -> dict[str, tuple[bytes, str]]:
    points, faces = rounded_box(1.0, 0.0)
    infinite = points.copy()
    infinite[0, 0] = np.nan
    turned = np.vstack([faces[1:], faces[:1, ::-1]])
    flat = np.array([[0, 1, 2], [0, 2, 1]])
    return {
        "picture": (b"\x89PNG" + bytes(range(200)), "not an STL"),
        "short": (b"sol", "not an STL"),
        "empty": (b"", "not an STL"),
        "cut off": (stl_bytes(points, faces)[:-20], "not an STL"),
        "words": (b"solid\nvertex one two three\n", "not an STL"),
        "odd vertices": (b"solid\nvertex 1 2 3\n", "not an STL"),
        "no faces": (stl_bytes(points, faces[:0]), "has no faces"),
        "no faces in text": (b"solid empty\nendsolid empty\n", "has no faces"),
        "NaN": (stl_bytes(infinite, faces), "faces with NaN"),
        "one hole": (stl_bytes(points, faces[1:]), "not watertight: 3 open edges"),
        "one flipped": (
            stl_bytes(points, turned),
            "not watertight",
        ),
        "zero volume": (stl_bytes(points, flat), "encloses no volume"),
        "all one point": (as_text(points * 0.0, faces), "encloses no volume"),
    }


@pytest.mark.parametrize("case", bad_files())
def test_bad_files_say_what_is_wrong(tmp_path: Path, case: str) -> None:
    """Each with a remedy, at the field `indenter`."""
    data, says = bad_files()[case]
    # numpy warns of nothing while judging them: warnings are errors here.
    with np.errstate(all="ignore"):
        path = written(tmp_path, data)
    with pytest.raises(DesignError, match=says) as caught:
        load_stl(path)
    assert caught.value.at == "indenter"
    assert caught.value.hint
    assert "tool.stl" in str(caught.value)


@pytest.mark.parametrize("edge_mm", [0.0, 0.45, 1.2])
@pytest.mark.parametrize("kind", PRIMITIVES)
def test_display_meshes_are_closed_and_on_the_shape(kind: IndenterKind, edge_mm: float) -> None:
    """Vertices lie on the very surface that contact uses, to rounding."""
    from sim.contact.objects.shape_distance import analytic_size, evaluate

    indenter = Indenter(kind=kind, edge_radius_mm=edge_mm)
    points, faces = display_mesh(indenter)
    assert is_watertight(faces)
    assert mesh_volume(points, faces) > 0.0
    distance, _ = evaluate(points, kind_of(kind).shape, analytic_size(indenter))
    assert np.abs(distance).max() < 1e-12


def test_display_volumes() -> None:
    """Sphere pi/6 s^3, cube s^3, cylinder pi/4 s^3, cone pi/24 s^3."""
    exact = {"sphere": math.pi / 6, "cube": 1.0, "cone": math.pi / 24}
    for kind in PRIMITIVES:
        indenter = Indenter(kind=kind, edge_radius_mm=0.0)
        share = mesh_volume(*display_mesh(indenter)) / 216.0
        # A 64-gon has 0.16 % less area than its circle, a faceted ball 0.4 % less volume.
        assert share == pytest.approx(exact.get(kind.value, math.pi / 4), rel=5e-3)


def test_a_cone_has_a_largest_edge_radius() -> None:
    """The inscribed circle of its section: 3 / (1 + sqrt 2) = 1.24 mm."""
    with pytest.raises(DesignError, match=r"the limit is 1\.24 mm"):
        display_mesh(Indenter(kind=IndenterKind.CONE, edge_radius_mm=1.3))


def test_loaded_mesh_is_shown_as_it_is(tmp_path: Path) -> None:
    """A ball of 4 mm stays one of 4 mm."""
    mesh = load_stl(written(tmp_path, stl_bytes(*sphere(2.0))))
    points, faces = display_mesh(Indenter(kind=IndenterKind.MESH, mesh=mesh, size_mm=4.0))
    assert np.array_equal(points, mesh.points_mm)
    assert np.array_equal(faces, mesh.faces)
