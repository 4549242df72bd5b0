"""VTK files hold exactly the arrays they were made of: same points, cells, types and regions."""

from __future__ import annotations

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import pyvista

from geometry.surface.primitives import rounded_box, sphere
from geometry.surface.stress import von_mises_MPa
from geometry.surface.surface import mesh_volume, vertex_normals
from geometry.workshop.vtk import contact_files, membrane_file, volume_file
from workbench.core.result.results import (
    Label,
    LabelledSurface,
    MembraneMesh,
    Skin,
    Solid,
    VolumeMesh,
)
from workbench.core.result.sensing import Contact
from workbench.report.vtkfiles import write_vtk

FRAMES = 2
DEPTHS_MM = (0.25, 0.5)
CUBE = np.array([[i & 1 ^ (i >> 1 & 1), i >> 1 & 1, i >> 2] for i in range(8)], dtype=np.float64)
"""Corners of the unit cube in VTK order."""


def reload(tmp_path: Path, name: str, content: bytes) -> Any:
    path = tmp_path / name
    path.write_bytes(content)
    return pyvista.read(path)


def volume(cells: list[list[int]]) -> VolumeMesh:
    """The unit cube, once or as tetrahedra, one corner on the base and in actuator 3."""
    labels = np.full(8, Label.OUTER, dtype=np.uint8)
    labels[0] |= np.uint8(Label.BASE | Label.ACTUATOR)
    numbers = np.full(8, -1, dtype=np.int16)
    numbers[0] = 3
    return VolumeMesh(
        points_mm=CUBE / 3.0,
        cells=np.array(cells, dtype=np.int32),
        labels=labels,
        quality=np.linspace(0.1, 1.0, len(cells), dtype=np.float32),
        layers=1,
        volume_mm3=1.0,
        numbers=numbers,
    )


HEXES = volume([[0, 1, 2, 3, 4, 5, 6, 7]])
TETS = volume([[0, 1, 2, 5], [0, 2, 7, 5], [0, 2, 3, 7], [0, 5, 7, 4], [2, 7, 5, 6]])


def skin(radius_mm: float, label: Label) -> Skin:
    points, faces = sphere(radius_mm)
    labels = np.full(len(faces), label, dtype=np.uint8)
    numbers = np.full(len(faces), -1, dtype=np.int16)
    labels[:5] |= np.uint8(Label.PIN)
    numbers[:5] = 7
    normals = vertex_normals(points, faces)
    return Skin(points_mm=points, faces=faces, normals=normals, labels=labels, numbers=numbers)


@pytest.fixture
def mesh() -> MembraneMesh:
    outer, inner = skin(3.0, Label.OUTER), skin(2.0, Label.INNER)
    return MembraneMesh(hexes=None, outer=outer, inner=inner, cavity=inner)


def membrane() -> LabelledSurface:
    """A box whose first four triangles lie on the base."""
    points, faces = rounded_box(2.0, 0.2)
    labels = np.full(len(faces), Label.OUTER, dtype=np.uint8)
    labels[:4] = Label.BASE
    return LabelledSurface(points_mm=points, faces=faces, labels=labels)


def contact(mesh: MembraneMesh, *, inner: bool) -> Contact:
    """Random numbers in the shapes of a press; the inner skin moves too, or not."""
    rng = np.random.default_rng(5)
    count, behind = len(mesh.outer.points_mm), len(mesh.inner.points_mm) if inner else 0
    return Contact(
        displacement_mm=rng.normal(size=(FRAMES, count, 3)).astype(np.float32),
        reaction_N=rng.normal(size=(FRAMES, 3)),
        moment_Nmm=rng.normal(size=(FRAMES, 3)),
        indenter_pose=rng.normal(size=(FRAMES, 7)),
        residual=rng.random(FRAMES),
        penetration_mm=rng.random(FRAMES),
        support_N=np.zeros((FRAMES, 3)),
        cut_N=np.zeros((FRAMES, 3)),
        friction_ratio=np.zeros(FRAMES),
        sliding=rng.random((FRAMES, count)) > 0.5,
        target_mm=np.zeros(3),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        grid_mm=0.5,
        active_radius_mm=5.0,
        particles=1,
        substeps=1,
        device="cpu",
        inner_mm=rng.normal(size=(FRAMES, behind, 3)).astype(np.float32),
        contact_force_N=rng.normal(size=(FRAMES, count, 3)).astype(np.float32),
        pressure_MPa=rng.normal(size=(FRAMES, count)).astype(np.float32),
        cauchy_MPa=rng.normal(size=(FRAMES, count, 6)).astype(np.float32),
        energy_MPa=rng.random((FRAMES, count), dtype=np.float32),
        slip_mm=rng.random((FRAMES, count), dtype=np.float32),
        actuator_N=rng.normal(size=(FRAMES, 2, 3)),
    )


def expect_regions(data: Any, labels: np.ndarray, numbers: np.ndarray) -> None:
    """`labels` uint8, `numbers` int16, and one uint8 array of 0 and 1 for each region."""
    assert data["labels"].dtype == np.uint8
    assert data["numbers"].dtype == np.int16
    np.testing.assert_array_equal(data["labels"], labels)
    np.testing.assert_array_equal(data["numbers"], numbers)
    for name in ("OUTER", "INNER", "BASE", "ACTUATOR", "PIN", "BACKED"):
        assert data[name].dtype == np.uint8
        np.testing.assert_array_equal(data[name], (labels & Label[name]) != 0)


@pytest.mark.parametrize(
    ("given", "kind"), [(HEXES, pyvista.CellType.HEXAHEDRON), (TETS, pyvista.CellType.TETRA)]
)
def test_volume_comes_back_exactly(tmp_path: Path, given: VolumeMesh, kind: int) -> None:
    """float64 points and float32 quality bit for bit, the same cells, the cube's volume 1/27."""
    grid = reload(tmp_path, "mesh.vtu", volume_file(given))
    assert grid.points.dtype == np.float64
    np.testing.assert_array_equal(grid.points, given.points_mm)
    assert (grid.celltypes == kind).all()
    np.testing.assert_array_equal(grid.cells_dict[kind], given.cells)
    assert grid.cell_data["quality"].dtype == np.float32
    np.testing.assert_array_equal(grid.cell_data["quality"], given.quality)
    expect_regions(grid.point_data, given.labels, given.numbers)
    # VTK's own volume is that only if the corners are in its order.
    assert grid.volume == pytest.approx(1.0 / 27.0, rel=1e-12)


def test_membrane_is_outer_then_inner_then_base(tmp_path: Path, mesh: MembraneMesh) -> None:
    """Both skins with their regions, the inner one turned over, and four faces on the base."""
    surface = reload(tmp_path, "membrane.vtp", membrane_file(mesh, membrane()))
    count, outer, inner = len(mesh.outer.points_mm), mesh.outer.faces, mesh.inner.faces
    faces = surface.regular_faces
    np.testing.assert_array_equal(surface.points[:count], mesh.outer.points_mm)
    np.testing.assert_array_equal(surface.points[count : 2 * count], mesh.inner.points_mm)
    np.testing.assert_array_equal(faces[: len(outer)], outer)
    np.testing.assert_array_equal(faces[len(outer) : -4], inner[:, ::-1] + count)
    labels = np.r_[mesh.outer.labels, mesh.inner.labels, np.full(4, Label.BASE, np.uint8)]
    numbers = np.r_[mesh.outer.numbers, mesh.inner.numbers, np.full(4, -1, np.int16)]
    expect_regions(surface.cell_data, labels, numbers)
    # Out of the elastomer on both sides: the volumes of the two spheres subtract.
    shell = mesh_volume(mesh.outer.points_mm, outer) - mesh_volume(mesh.inner.points_mm, inner)
    assert mesh_volume(np.asarray(surface.points), faces[:-4]) == pytest.approx(shell, rel=1e-12)


def test_vertices_carry_the_regions_of_the_faces_that_meet_there(
    tmp_path: Path, mesh: MembraneMesh
) -> None:
    """The vertices of the first five faces are in pin 7, all others are not."""
    surface = reload(tmp_path, "membrane.vtp", membrane_file(mesh, membrane()))
    count = len(mesh.outer.points_mm)
    pinned = np.isin(np.arange(count), mesh.outer.faces[:5])
    np.testing.assert_array_equal(surface.point_data["PIN"][:count], pinned)
    np.testing.assert_array_equal(surface.point_data["numbers"][:count], np.where(pinned, 7, -1))


@pytest.mark.parametrize("inner", [False, True])
def test_frames_of_a_press_come_back_exactly(
    tmp_path: Path, mesh: MembraneMesh, inner: bool
) -> None:
    """Undeformed points, float32 displacement, 0 or 1 for sliding, float64 forces of the frame."""
    press = contact(mesh, inner=inner)
    files = contact_files(mesh, press, DEPTHS_MM)
    assert list(files) == ["contact_000.vtp", "contact_001.vtp", "contact.pvd"]
    for k, (name, content) in enumerate(list(files.items())[:FRAMES]):
        surface = reload(tmp_path, name, content)
        moved, behind = press.displacement_mm[k], press.inner_mm[k]
        skins = [mesh.outer, mesh.inner] if inner else [mesh.outer]
        np.testing.assert_array_equal(surface.points, np.concatenate([s.points_mm for s in skins]))
        assert surface.point_data["displacement_mm"].dtype == np.float32
        np.testing.assert_array_equal(
            surface.point_data["displacement_mm"], np.concatenate([moved, behind])
        )
        np.testing.assert_array_equal(
            surface.point_data["sliding"], np.pad(press.sliding[k], (0, len(behind)))
        )
        for field in ("contact_force_N", "pressure_MPa", "cauchy_MPa", "energy_MPa", "slip_mm"):
            found, given = surface.point_data[field], getattr(press, field)[k]
            assert found.dtype == np.float32
            np.testing.assert_array_equal(found[: len(moved)], given)
            assert not found[len(moved) :].any()
        mises = von_mises_MPa(press.cauchy_MPa[k])
        np.testing.assert_array_equal(surface.point_data["von_mises_MPa"][: len(moved)], mises)
        np.testing.assert_array_equal(surface.field_data["actuator_N"], press.actuator_N[k])
        expect_regions(surface.cell_data, *(np.concatenate(a) for a in regions_of(skins)))
        for field in ("reaction_N", "moment_Nmm", "indenter_pose"):
            assert surface.field_data[field].dtype == np.float64
            np.testing.assert_array_equal(surface.field_data[field][0], getattr(press, field)[k])
        assert surface.field_data["normal_N"][0] == press.normal_N[k]
        assert surface.field_data["depth_mm"][0] == DEPTHS_MM[k]


def regions_of(skins: list[Skin]) -> tuple[list[np.ndarray], list[np.ndarray]]:
    return [s.labels for s in skins], [s.numbers for s in skins]


def test_series_lists_the_frames_in_order(tmp_path: Path, mesh: MembraneMesh) -> None:
    """ParaView's times are the frame numbers; each leads to its file."""
    press = contact(mesh, inner=False)
    for name, content in contact_files(mesh, press, DEPTHS_MM).items():
        (tmp_path / name).write_bytes(content)
    reader: Any = pyvista.get_reader(tmp_path / "contact.pvd")
    assert reader.time_values == [0.0, 1.0]
    reader.set_active_time_point(1)
    (frame,) = reader.read()
    np.testing.assert_array_equal(frame.point_data["displacement_mm"], press.displacement_mm[1])


def test_files_of_an_earlier_run_go(tmp_path: Path, mesh: MembraneMesh) -> None:
    """Without cells no mesh.vtu stays; tetrahedra stand in for hexahedra."""
    nothing = np.zeros(0, dtype=np.uint8)
    solid = Solid(
        membrane=membrane(),
        support=membrane(),
        base=membrane(),
        outer_brep=nothing,
        core_brep=nothing,
        membrane_brep=nothing,
        support_brep=nothing,
        base_brep=nothing,
        volume_mm3=1.0,
    )
    full = dataclasses.replace(mesh, hexes=HEXES)
    press = contact(mesh, inner=False)
    names = write_vtk(tmp_path, solid, full, contact=press, depth_mm=DEPTHS_MM)
    assert {path.name for path in tmp_path.iterdir()} == set(names)
    assert write_vtk(tmp_path, solid, mesh) == ["membrane.vtp"]
    assert [path.name for path in tmp_path.iterdir()] == ["membrane.vtp"]
    assert write_vtk(tmp_path, solid, mesh, tets=TETS) == ["mesh.vtu", "membrane.vtp"]
    assert pyvista.read(tmp_path / "mesh.vtu").n_cells == len(TETS.cells)
