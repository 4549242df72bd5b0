"""Objects from files and by name: STL, OBJ, STEP, everyday things, and their sampled distances."""

from __future__ import annotations

import itertools
from pathlib import Path

import numpy as np
import pytest

from geometry.objects.everyday import EVERYDAY, everyday
from geometry.objects.indenters import load_mesh
from geometry.surface.primitives import rounded_box, sphere
from geometry.surface.surface import is_watertight, mesh_volume
from geometry.workshop.export import stl_bytes
from sim.contact.motion.approach import plan_approach
from sim.contact.objects import sampling
from sim.contact.objects.collider import make_collider
from sim.contact.objects.sampling import kept_samples, sample_indenter
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.press import Press
from workbench.core.press.texture import HeightImage, Pattern, Texture
from workbench.edit.indenter_choice import choose_indenter
from workbench.project.kept_indenters import indenter_table, read_indenter
from workbench.project.project import Project

BLOCK, _ = flat_block(width_mm=16.0, height_mm=4.0, grid_mm=1.0)


def box_indenter(size_mm: float = 6.0, rounding_mm: float = 0.0) -> Indenter:
    points, faces = rounded_box(size_mm / 2, 0.0)
    mesh = IndenterMesh(points_mm=points, faces=faces)
    return Indenter(
        kind=IndenterKind.MESH, mesh=mesh, size_mm=size_mm, mesh_rounding_mm=rounding_mm
    )


def obj_text(points: np.ndarray, faces: np.ndarray) -> str:
    vertices = ["v " + " ".join(repr(float(x)) for x in point) for point in points]
    return "\n".join([*vertices, *("f " + " ".join(f"{i + 1}//1" for i in f) for f in faces)])


def touch_mm(collider) -> float:
    return plan_approach(BLOCK.outer, collider, Press(target_mm=(0.13, -0.07, 4.0))).touch_mm


def test_obj_with_quads_comes_back_as_the_box(tmp_path: Path) -> None:
    """Six quads of a 2 x 4 x 6 box, indices from the end: 48 mm3, 12 triangles, centred."""
    corners = np.array(list(itertools.product((0, 2), (0, 4), (0, 6))), dtype=float)
    quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    path = tmp_path / "box.obj"
    path.write_text(
        "# a box\nmtllib none.mtl\n"
        + obj_text(corners, np.zeros((0, 3), int))
        + "\n"
        + "\n".join("f " + " ".join(str(i - 8) for i in quad) for quad in quads)
    )
    mesh = load_mesh(path)
    assert len(mesh.faces) == 12
    assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(48.0)
    assert mesh.points_mm.max(axis=0) == pytest.approx([1.0, 2.0, 3.0])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("v 0 0 zero", "not an OBJ"),
        ("v 0 0 0\nf 1 2 3", "a vertex that is not there"),
        ("v 0 0 0\nv 1 0 0\nv nan 1 0\nf 1 2 3", "NaN"),
        ("", "has no faces"),
        ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "not watertight: 3 open edges"),
    ],
)
def test_bad_obj_files_say_what_is_wrong(tmp_path: Path, text: str, says: str) -> None:
    """Each with a remedy, at the field `indenter`."""
    path = tmp_path / "tool.obj"
    path.write_text(text)
    with pytest.raises(DesignError, match=says) as caught:
        load_mesh(path)
    assert caught.value.at == "indenter"
    assert caught.value.hint


def test_step_file_comes_back_in_mm(tmp_path: Path) -> None:
    """A 10 x 20 x 30 box written as STEP: 6,000 mm3, centred."""
    from build123d import Box, export_step

    path = tmp_path / "box.step"
    export_step(Box(10, 20, 30), str(path))
    indenter = choose_indenter(str(path))
    assert indenter.mesh is not None
    assert indenter.size_mm == pytest.approx(30.0)
    mesh = indenter.mesh
    assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(6000.0)
    assert mesh.points_mm.min(axis=0) == pytest.approx([-5.0, -10.0, -15.0])
    path.write_text("not a STEP file")
    with pytest.raises(DesignError, match=r"box\.step is not a STEP file") as caught:
        choose_indenter(str(path))
    assert caught.value.at == "indenter"


def test_inside_out_mesh_is_turned_and_said_so(tmp_path: Path) -> None:
    """The notice names the file; a mesh that is right has none; neither changes the key."""
    from workbench.core.base.digest import digest

    points, faces = rounded_box(2.0, 0.0)
    path = tmp_path / "tool.stl"
    path.write_bytes(stl_bytes(points, faces[:, ::-1]))
    mesh = load_mesh(path)
    assert mesh.notice == "tool.stl was inside out and has been turned"
    assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(64.0)
    quiet = IndenterMesh(points_mm=mesh.points_mm, faces=mesh.faces)
    assert digest(quiet) == digest(mesh)
    path.write_bytes(stl_bytes(points, faces))
    assert load_mesh(path).notice == ""


def test_scan_with_too_many_triangles_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before it is welded: counts and limit are named. A scan of 5 million fails by its size."""
    from geometry.objects import indenters

    points, faces = sphere(3.0)
    path = tmp_path / "scan.stl"
    path.write_bytes(stl_bytes(points, faces))
    monkeypatch.setattr(indenters, "MOST_TRIANGLES", 1000)
    with pytest.raises(DesignError, match=r"scan\.stl has 3,968 triangles, more than 1,000"):
        load_mesh(path)
    with path.open("wb") as file:
        file.truncate(84 + 50 * 5_000_000)
    with pytest.raises(DesignError, match="has 250 MB, more than 64 MB"):
        load_mesh(path)


@pytest.mark.parametrize(("apart_mm", "closed"), [(2e-6, True), (1e-3, False)])
def test_corners_that_are_nearly_one_close_a_file(
    tmp_path: Path, apart_mm: float, closed: bool
) -> None:
    """A box of 20 mm whose corners each triangle rounds differently, as some programs write them.

    Nanometres are rounding; a micrometre may be a gap, and is refused as one.
    """
    points, faces = rounded_box(10.0, 0.0)
    corners = points[faces] + np.random.default_rng(3).uniform(0.0, apart_mm, (len(faces), 3, 3))
    lines = [f"vertex {x:.9f} {y:.9f} {z:.9f}" for x, y, z in corners.reshape(-1, 3)]
    path = tmp_path / "box.stl"
    path.write_text("solid box\n" + "\n".join(lines) + "\nendsolid")
    if not closed:
        with pytest.raises(DesignError, match="not watertight"):
            load_mesh(path)
        return
    mesh = load_mesh(path)
    assert is_watertight(mesh.faces)
    assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(8000.0, rel=1e-5)


@pytest.mark.parametrize(
    ("name", "size_mm", "volume_mm3"),
    [
        ("mug", (80.0, 82.0), 101e3),
        ("screwdriver", (31.0, 215.0), 73e3),
        ("banana", (36, 190), 161e3),
    ],
)
def test_everyday_objects_are_closed_and_of_real_size(
    name: str, size_mm: tuple[float, float], volume_mm3: float
) -> None:
    """X and Y widths as in the YCB table; one closed outward body."""
    mesh = everyday(name)
    assert is_watertight(mesh.faces)
    # A regression value: none of the three has a closed form.
    assert mesh_volume(mesh.points_mm, mesh.faces) == pytest.approx(volume_mm3, rel=0.02)
    assert np.ptp(mesh.points_mm, axis=0)[:2] == pytest.approx(size_mm, abs=0.2)
    indenter = choose_indenter(name)
    assert indenter.size_mm == pytest.approx(np.ptp(mesh.points_mm, axis=0).max())
    lowest = mesh.points_mm[np.argmin(mesh.points_mm[:, 2])]
    assert abs(lowest[0]) < 2.0


@pytest.mark.parametrize("name", EVERYDAY)
def test_window_samples_a_large_object_finely_and_touches_alike(
    taichi_device: str, name: str
) -> None:
    """24 x 24 x 9 mm about the lowest place: samples of 0.2 mm instead of more than 0.4."""
    indenter = choose_indenter(name)
    whole = make_collider(indenter, grid_mm=0.5)
    low = -whole.half_height_mm
    window = ((-12.0, -12.0, low - 3.0), (12.0, 12.0, low + 6.0))
    part = make_collider(indenter, grid_mm=0.5, window_mm=window)
    assert 1.0 / part.size[3] == pytest.approx(0.2)
    assert 1.0 / whole.size[3] > 0.4
    assert part.samples.size < 1_000_000
    assert touch_mm(part) == pytest.approx(whole.half_height_mm, abs=2e-3)
    assert touch_mm(whole) == pytest.approx(whole.half_height_mm, abs=0.02)


def test_outside_a_window_the_distance_is_a_positive_lower_bound(taichi_device: str) -> None:
    """A 40 mm ball seen through a window of 8 mm: nowhere more than the exact distance."""
    points, faces = sphere(20.0)
    mesh = IndenterMesh(points_mm=points, faces=faces)
    indenter = Indenter(kind=IndenterKind.MESH, mesh=mesh, size_mm=40.0)
    part = make_collider(indenter, grid_mm=0.5, window_mm=((-4.0, -4.0, -22.0), (4.0, 4.0, -14.0)))
    where = np.random.default_rng(5).uniform(-30.0, 30.0, (4000, 3))
    exact = np.linalg.norm(where, axis=1) - 20.0
    found = part.distance(where)[0]
    outside = exact > 1.0
    # Facets of the ball sag by 0.1 mm.
    assert (found[outside] <= exact[outside] + 0.12).all()
    assert (found[outside] > 0.0).all()
    inside = np.array([[0.0, 0.0, -19.0], [1.0, 1.0, -19.3]])
    exact = np.linalg.norm(inside, axis=1) - 20.0
    assert part.distance(inside)[0] == pytest.approx(exact, abs=0.12)


def test_window_beside_the_object_is_a_bug_of_the_caller() -> None:
    """Nothing of a 6 mm hexagon lies beyond x = 10."""
    with pytest.raises(ValueError, match="holds no part"):
        make_collider(
            Indenter(kind=IndenterKind.HEXAGON),
            grid_mm=0.5,
            window_mm=((10.0, -1.0, -1.0), (12.0, 1.0, 1.0)),
        )


def test_rounded_mesh_is_the_rounded_cube(taichi_device: str) -> None:
    """A sharp box mesh of 6.13 mm with 0.45 mm against the closed form, within 0.05 mm of it.

    99 of 100 places are right to a tenth of a sample of 0.2 mm; corners to 0.4.
    """
    rounded = make_collider(box_indenter(6.13, 0.45), grid_mm=0.5)
    cube = Indenter(kind=IndenterKind.CUBE, size_mm=6.13, edge_radius_mm=0.45)
    where = np.random.default_rng(0).uniform(-3.4, 3.4, (40000, 3))
    exact = make_collider(cube, grid_mm=0.5).distance(where)[0]
    near = np.abs(exact) < 0.05
    error = np.abs(rounded.distance(where)[0] - exact)[near]
    assert np.percentile(error, 99) < 0.02
    assert error.max() < 0.08
    assert rounded.least_radius_mm == 0.45
    sharp = make_collider(box_indenter(6.13), grid_mm=0.5)
    edge = np.array([[0.0, 6.13 / 2, -6.13 / 2]])
    cut = 0.45 * (2**0.5 - 1.0)
    assert rounded.distance(edge)[0][0] == pytest.approx(cut, abs=0.03)
    assert sharp.distance(edge)[0][0] < 0.25 * cut


def test_rounding_that_leaves_nothing_is_refused(taichi_device: str) -> None:
    """A plate 0.6 mm thick has no room for 0.5 mm; other kinds have edges of their own."""
    points, faces = rounded_box(3.0, 0.0)
    mesh = IndenterMesh(points_mm=points * [1.0, 1.0, 0.1], faces=faces)
    plate = Indenter(kind=IndenterKind.MESH, mesh=mesh, mesh_rounding_mm=0.5)
    with pytest.raises(DesignError, match="leaves nothing of the indenter mesh") as caught:
        make_collider(plate, grid_mm=0.5)
    assert caught.value.at == "indenter.mesh_rounding_mm"
    with pytest.raises(DesignError, match="mesh rounding"):
        Indenter(mesh_rounding_mm=0.2)


def test_samples_are_computed_once(monkeypatch: pytest.MonkeyPatch) -> None:
    """Equal content gives the same arrays; the oldest go when there are too many bytes."""
    monkeypatch.setattr(sampling, "_kept", type(sampling._kept)())
    ring = Indenter(kind=IndenterKind.RING)
    first = kept_samples(ring, grid_mm=0.5)
    assert kept_samples(Indenter(kind=IndenterKind.RING), grid_mm=0.5) is first
    assert kept_samples(ring, grid_mm=1.0) is not first
    np.testing.assert_array_equal(
        sample_indenter(ring, grid_mm=0.5).coefficients, first.coefficients
    )
    # What a store kept is taken as it is.
    stored = make_collider(ring, grid_mm=0.5, whole=first)
    assert stored.samples is first.coefficients
    monkeypatch.setattr(sampling, "MOST_BYTES", first.coefficients.nbytes)
    kept_samples(Indenter(kind=IndenterKind.TORUS), grid_mm=0.5)
    assert kept_samples(ring, grid_mm=0.5) is not first


def test_indenters_come_back_from_a_project(tmp_path: Path) -> None:
    """A rounded mesh of 215 mm with waves, and a cube with a picture: all fields, equal keys."""
    from workbench.core.base.digest import digest

    project = Project(tmp_path)
    image = HeightImage(heights=np.linspace(0.0, 1.0, 12).reshape(3, 4))
    cases = [
        choose_indenter(
            "screwdriver", edge_radius_mm=0.3, texture=Texture(pattern=Pattern.WAVES, pitch_mm=3.0)
        ),
        Indenter(
            kind=IndenterKind.CUBE,
            texture=Texture(pattern=Pattern.IMAGE, image=image, height_mm=0.1, pitch_mm=4.0),
        ),
        Indenter(kind=IndenterKind.FLOWER, edge_radius_mm=0.3),
    ]
    for indenter in cases:
        table = indenter_table(indenter, project)
        assert digest(read_indenter(table, project)) == digest(indenter)
    with pytest.raises(DesignError, match="not in the project"):
        read_indenter({"kind": "mesh", "mesh_key": "0" * 32}, project)


def test_unknown_names_suggest_the_nearest() -> None:
    """`bananna` is a banana."""
    with pytest.raises(DesignError, match="no indenter 'bananna'") as caught:
        choose_indenter("bananna")
    assert "did you mean 'banana'?" in caught.value.hint
