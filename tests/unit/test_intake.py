"""Files that people really have: repaired and said so, or refused with place and remedy."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry.intake.intake import read_body, smooth_patches
from geometry.surface.surface import is_watertight, mesh_volume
from workbench.core.base.errors import DesignError
from workbench.core.design.imported import ImportedBody, LengthUnit, ReadBody, body_file


def drum(radius: float = 12.0, height: float = 20.0) -> tuple[np.ndarray, np.ndarray]:
    """A cylinder of 24 sides that stands on z = 0."""
    import trimesh

    mesh = trimesh.creation.cylinder(radius, height, sections=24)
    return np.add(mesh.vertices, [0.0, 0.0, height / 2]), np.asarray(mesh.faces)


def read(points: np.ndarray, faces: np.ndarray, unit: LengthUnit = LengthUnit.AUTO) -> ReadBody:
    import trimesh

    # Not our own writer, which is for millimetres and leaves out what is degenerate.
    data: Any = trimesh.Trimesh(points, faces, process=False).export(file_type="stl")
    file = body_file("drum.stl", data)
    return read_body(ImportedBody(outer=file, unit=unit))


POINTS, FACES = drum()
VOLUME_MM3 = mesh_volume(POINTS, FACES)


def on_base(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    return np.abs(points[faces][:, :, 2]).max(axis=1) < 1e-9


def test_a_clean_file_in_mm_needs_no_notice() -> None:
    """24-sided drum of radius 12 and height 20: its volume, three smooth patches, no notice."""
    body = read(POINTS, FACES)
    assert body.unit == "mm"
    assert body.notice == ""
    # STL stores float32.
    assert mesh_volume(body.outer.points_mm, body.outer.faces) == pytest.approx(VOLUME_MM3, 1e-6)
    assert len(np.unique(body.outer.patch)) == 3


@pytest.mark.parametrize(
    ("per_mm", "unit", "given"),
    [
        (1 / 1000, LengthUnit.M, LengthUnit.AUTO),
        (1 / 25.4, LengthUnit.INCH, LengthUnit.INCH),
        (1 / 10, LengthUnit.CM, LengthUnit.CM),
    ],
)
def test_units_are_inferred_where_only_one_fits(
    per_mm: float, unit: LengthUnit, given: LengthUnit
) -> None:
    """0.024 can only be metres; inch and cm must be given. The volume is that in mm."""
    body = read(POINTS * per_mm, FACES, given)
    assert body.unit == unit.value
    # STL stores float32.
    assert mesh_volume(body.outer.points_mm, body.outer.faces) == pytest.approx(VOLUME_MM3, 1e-5)
    assert (f"taken as {unit.value}" in body.notice) == (given is LengthUnit.AUTO)


def test_a_size_that_fits_two_units_is_asked_for() -> None:
    """0.94 units long: 9.4 mm in cm and 24 mm in inch; the message lists both."""
    with pytest.raises(DesignError, match=r"cm: 9\.45 mm, inch: 24 mm") as caught:
        read(POINTS / 25.4, FACES)
    assert caught.value.at == "body.unit"


def test_small_sensors_in_mm_may_be_large_ones_in_cm() -> None:
    """9 units are taken as mm, and the notice says what they would be in cm."""
    body = read(POINTS * 9.0 / 24.0, FACES)
    assert body.unit == "mm"
    assert "taken as 9 mm long; if it is 90 mm, choose cm" in body.notice


def test_notices_do_not_depend_on_names() -> None:
    """The same bytes under two names give the same result: the store knows them by content."""
    data = text_stl(*inside_out())
    first, second = (
        read_body(ImportedBody(outer=body_file(name, data))) for name in ("a.stl", "b.stl")
    )
    assert first.notice == second.notice != ""


def test_an_inner_stl_has_its_own_unit_beside_a_step(tmp_path: Path) -> None:
    """STEP in mm, STL given in cm: 0.6 x 0.6 x 1 cm are 6 x 6 x 10 mm."""
    import trimesh
    from build123d import Box

    outer = body_file("o.step", written(Box(20, 20, 30), tmp_path / "o.step"))
    box = trimesh.creation.box((0.6, 0.6, 1.0))
    inner = body_file("i.stl", text_stl(np.asarray(box.vertices), np.asarray(box.faces)))
    body = read_body(ImportedBody(outer=outer, inner=inner, unit=LengthUnit.CM))
    assert body.inner is not None
    assert np.ptp(body.inner.points_mm, axis=0) == pytest.approx([6.0, 6.0, 10.0])


def test_a_bad_inner_file_is_refused_at_its_own_field() -> None:
    """The outer file is fine; the message belongs under the other button."""
    outer, inner = body_file("o.stl", text_stl(POINTS, FACES)), body_file("i.stl", b"hello")
    with pytest.raises(DesignError, match=r"i\.stl is not an STL") as caught:
        read_body(ImportedBody(outer=outer, inner=inner))
    assert caught.value.at == "body.inner"


def open_base() -> tuple[np.ndarray, np.ndarray]:
    return POINTS, FACES[~on_base(POINTS, FACES)]


def doubled() -> tuple[np.ndarray, np.ndarray]:
    return POINTS, np.vstack([FACES, FACES[:5]])


def inside_out() -> tuple[np.ndarray, np.ndarray]:
    return POINTS, FACES[:, ::-1]


def wound_wrong() -> tuple[np.ndarray, np.ndarray]:
    faces = FACES.copy()
    faces[3] = faces[3, ::-1]
    return POINTS, faces


def with_debris() -> tuple[np.ndarray, np.ndarray]:
    small = np.add(POINTS * 0.002, [30.0, 0.0, 0.0])
    return np.vstack([POINTS, small]), np.vstack([FACES, FACES + len(POINTS)])


def almost_touching() -> tuple[np.ndarray, np.ndarray]:
    corners = POINTS[FACES] + np.linspace(0.0, 2e-5, len(FACES))[:, None, None]
    return corners.reshape(-1, 3), np.arange(3 * len(FACES)).reshape(-1, 3)


@pytest.mark.parametrize(
    ("made", "says"),
    [
        (open_base, "a flat opening 24 wide at .* was capped"),
        (doubled, "5 doubled triangles were removed"),
        (inside_out, "inside out"),
        (wound_wrong, "wrong way were turned"),
        (with_debris, "1 loose pieces of debris"),
        (almost_touching, "vertices were merged"),
    ],
)
def test_safe_repairs_are_made_and_said(
    made: Callable[[], tuple[np.ndarray, np.ndarray]], says: str
) -> None:
    """Each ends watertight with the drum's volume."""
    body = read(*made())
    outer = body.outer
    assert is_watertight(outer.faces)
    # Vertices were moved by up to 2e-5 of 12 mm.
    assert mesh_volume(outer.points_mm, outer.faces) == pytest.approx(VOLUME_MM3, rel=1e-5)
    assert re.search(says, body.notice), body.notice


def side_hole() -> tuple[np.ndarray, np.ndarray]:
    middle = POINTS[FACES].mean(axis=1)
    return POINTS, FACES[~((middle[:, 0] > 8.0) & (np.ptp(POINTS[FACES][:, :, 2], axis=1) > 1.0))]


def two_bodies() -> tuple[np.ndarray, np.ndarray]:
    return np.vstack([POINTS, np.add(POINTS, [50.0, 0.0, 0.0])]), np.vstack(
        [FACES, FACES + len(POINTS)]
    )


def bumps() -> tuple[np.ndarray, np.ndarray]:
    """A texture of 40 balls of 0.6 mm that were not united with the drum: not debris."""
    import trimesh

    ball = trimesh.creation.icosphere(1, 0.6)
    turn = np.linspace(0.0, 6.0, 40)
    places = np.column_stack([12 * np.cos(turn), 12 * np.sin(turn), np.linspace(2, 18, 40)])
    points = [POINTS, *[np.add(ball.vertices, place) for place in places]]
    starts = np.cumsum([0, *map(len, points[:-1])])
    faces = [FACES, *[np.add(ball.faces, start) for start in starts[1:]]]
    return np.vstack(points), np.vstack(faces)


def fin() -> tuple[np.ndarray, np.ndarray]:
    """One stray triangle that stands on an edge."""
    tip = [*POINTS[FACES[0]].mean(axis=0) + 3.0]
    return np.vstack([POINTS, tip]), np.vstack([FACES, [[FACES[0, 0], FACES[0, 1], len(POINTS)]]])


def folded() -> tuple[np.ndarray, np.ndarray]:
    import trimesh

    ball = trimesh.creation.icosphere(2, 12.0)
    points = np.array(ball.vertices)
    points[np.argmax(points[:, 2])] = [3.0, 2.0, -30.0]
    return points, np.asarray(ball.faces)


def sheet() -> tuple[np.ndarray, np.ndarray]:
    return POINTS * [1.0, 1.0, 0.0], FACES


def broken() -> tuple[np.ndarray, np.ndarray]:
    points = POINTS.copy()
    points[3, 1] = np.nan
    return points, FACES


@pytest.mark.parametrize(
    ("made", "says"),
    [
        (side_hole, r"drum\.stl is open: a hole .* wide at \(.*\), larger than 5 % of the body"),
        (two_bodies, "holds 2 bodies"),
        (bumps, "holds 41 bodies"),
        (fin, r"drum\.stl is open: \d+ edges have no partner"),
        (folded, r"faces of drum\.stl cut through each other, near \("),
        (sheet, "drum.stl"),
        (broken, "NaN"),
    ],
)
def test_what_cannot_be_mended_is_refused_with_its_place(
    made: Callable[[], tuple[np.ndarray, np.ndarray]], says: str
) -> None:
    """Every refusal names the file and a remedy."""
    with pytest.raises(DesignError, match=says) as caught:
        read(*made())
    assert caught.value.hint
    assert caught.value.at == "body.outer"


@pytest.mark.parametrize(
    ("name", "data", "says"),
    [
        ("a.stl", b"hello", "not an STL"),
        ("a.stl", b"solid a\nendsolid a\n", "no faces"),
        ("a.stl", b"solid a\nvertex 1 2\nvertex 1 2 3\n", "not an STL"),
        ("a.step", b"ISO-10303-21; hello", "a.step"),
        ("a.step", b"", "a.step"),
    ],
)
def test_garbage_is_refused(name: str, data: bytes, says: str) -> None:
    """A DesignError, never an error of a library."""
    with pytest.raises(DesignError, match=says):
        read_body(ImportedBody(outer=body_file(name, data)))


def text_stl(points: np.ndarray, faces: np.ndarray) -> bytes:
    """A text STL with capitals, tabs and ends of lines of another system."""
    lines = ["solid drum"]
    for corners in points[faces]:
        lines += ["\tfacet normal 0 0 0", "outer loop"]
        lines += ["\tvertex " + " ".join(repr(float(c)) for c in corner) for corner in corners]
        lines += ["endloop", "endfacet"]
    return "\r\n".join([*lines, "endsolid"]).encode()


def test_a_text_stl_is_read() -> None:
    """The same body as the binary one."""
    body = read_body(ImportedBody(outer=body_file("DRUM.STL", text_stl(POINTS, FACES))))
    assert mesh_volume(body.outer.points_mm, body.outer.faces) == pytest.approx(VOLUME_MM3)


def test_other_endings_are_refused() -> None:
    """An OBJ is neither STL nor STEP."""
    with pytest.raises(DesignError, match="neither an STL nor a STEP"):
        body_file("a.obj", b"")


def written(shape: Any, path: Path, **options: Any) -> bytes:
    from build123d import export_step

    export_step(shape, str(path), **options)
    return path.read_bytes()


def test_step_files_say_their_unit(tmp_path: Path) -> None:
    """A box of 1 x 1 x 2 inch holds 25.4^3 x 2 = 32774.1 mm3, six faces, without a notice."""
    from build123d import Box, Unit

    # build123d writes its numbers as they are and only names the unit.
    data = written(Box(1, 1, 2), tmp_path / "box.step", unit=Unit.IN)
    body = read_body(ImportedBody(outer=body_file("box.step", data)))
    exact = 2 * 25.4**3
    assert mesh_volume(body.outer.points_mm, body.outer.faces) == pytest.approx(exact, rel=1e-9)
    assert len(np.unique(body.outer.patch)) == 6
    assert body.notice == ""


def test_step_with_two_solids_or_a_bow_tie_is_refused(tmp_path: Path) -> None:
    """Two boxes are two bodies; a prism on a crossed outline encloses nothing sound."""
    from build123d import Box, Compound, Face, Pos, Solid, Vector, Wire

    two = Compound([Box(20, 20, 20), Pos(40, 0, 0) * Box(20, 20, 20)])
    data = written(two, tmp_path / "two.step")
    with pytest.raises(DesignError, match=r"two.step holds 2 bodies \(volumes 8000, 8000"):
        read_body(ImportedBody(outer=body_file("two.step", data)))
    crossed = Face(Wire.make_polygon([(0, 0), (20, 20), (20, 0), (0, 20)], close=True))
    data = written(Solid.extrude(crossed, Vector(0, 0, 20)), tmp_path / "bow.step")
    with pytest.raises(DesignError, match=r"bow.step"):
        read_body(ImportedBody(outer=body_file("bow.step", data)))


def test_patches_end_at_sharp_edges() -> None:
    """A box has six of two triangles each; a ball of 320 faces is one."""
    import trimesh

    box = trimesh.creation.box((10.0, 10.0, 10.0))
    found = smooth_patches(np.asarray(box.vertices), np.asarray(box.faces))
    assert np.bincount(found).tolist() == [2] * 6
    ball = trimesh.creation.icosphere(2, 5.0)
    assert smooth_patches(np.asarray(ball.vertices), np.asarray(ball.faces)).max() == 0
