"""Meshes of every family: conforming, closed, labelled, and of the body's volume."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from scipy.spatial import ConvexHull

from geometry.surface.surface import face_areas, is_watertight, mesh_volume
from geometry.volume.lattice import material_points
from geometry.volume.quality import quality_report, skin_quality, tetrahedron_quality
from geometry.volume.tets import boundary_faces, tetrahedra
from sim.optics.camera.inside_skin import inside
from workbench.core.design.design import Meshing, SensorDesign
from workbench.core.result.results import Label, MembraneMesh, Skin, Solid, VolumeMesh, region_masks
from workbench.proof.validation.geometry.meshes import family_names, worst_area_error

HEX_FAMILIES = ("finger", "pad", "paw", "thumb", "trunk")
CELL_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
"""Corners of each side of a hexahedron in VTK order, counter-clockwise from outside."""


Built = Callable[[str], Solid]
Meshed = Callable[[str], MembraneMesh]


@pytest.fixture(scope="module")
def coarse(made: Callable[[SensorDesign, str], Any]) -> Meshed:
    """A function that returns the meshes of a family's default shape at 0.6 mm."""
    meshing = Meshing(hex_mm=0.6)
    return lambda family: made(SensorDesign(family=family, meshing=meshing), "mesh")


def hexahedra(meshes: MembraneMesh) -> VolumeMesh:
    """The hexahedra of a shape that has some."""
    assert meshes.hexes is not None, meshes.notice
    return meshes.hexes


def free_quads(cells: np.ndarray) -> np.ndarray:
    """Sides of hexahedra that belong to one cell; every other must belong to exactly two."""
    faces = cells[:, CELL_FACES].reshape(-1, 4)
    _, first, count = np.unique(
        np.sort(faces, axis=1), axis=0, return_index=True, return_counts=True
    )
    assert set(np.unique(count)) == {1, 2}
    return faces[first[count == 1]]


def test_exactly_these_families_have_hexahedra(coarse: Meshed) -> None:
    """Suckers and pins cannot be layered; all other shapes can, and the others say why not."""
    found = {name for name in family_names() if coarse(name).hexes is not None}
    assert found == set(HEX_FAMILIES)
    assert all(coarse(name).notice for name in set(family_names()) - found)
    assert not any(coarse(name).notice for name in found)


@pytest.mark.parametrize("family", HEX_FAMILIES)
def test_hexahedra_conform_and_their_boundary_is_the_skins(family: str, coarse: Meshed) -> None:
    """Inner sides are shared by two cells; free ones are outer + inner + base, a closed surface."""
    hexes = hexahedra(coarse(family))
    quads = free_quads(hexes.cells)
    triangles = np.concatenate([quads[:, :3], quads[:, [0, 2, 3]]])
    assert is_watertight(triangles)
    # Diagonals of sides that are not plane: exact for none, but small against the wall.
    enclosed = mesh_volume(hexes.points_mm, triangles)
    assert enclosed == pytest.approx(hexes.volume_mm3, rel=2e-3)
    corners = hexes.labels[quads]
    on_base = (corners & Label.BASE != 0).all(axis=1)
    outer = (corners & Label.OUTER != 0).all(axis=1) & ~on_base
    inner = (corners & Label.INNER != 0).all(axis=1) & ~on_base
    assert (on_base | outer | inner).all()
    meshes = coarse(family)
    # No side has all corners on both skins: the wall has two layers at least.
    assert 2 * outer.sum() == len(meshes.outer.faces)
    assert 2 * inner.sum() == len(meshes.inner.faces)
    for skin, label in ((meshes.outer, Label.OUTER), (meshes.inner, Label.INNER)):
        nodes = hexes.points_mm[hexes.labels & label != 0]
        assert np.array_equal(nodes, skin.points_mm)


@pytest.mark.parametrize("family", HEX_FAMILIES)
def test_hexahedra_are_good(family: str, default_solid: Built, coarse: Meshed) -> None:
    """Scaled Jacobian at least 0.3, 95 % of edges at most 1.6 h, volume ratio 1, at 0.6 mm."""
    report = quality_report(coarse(family), default_solid(family).volume_mm3).volume
    assert report is not None
    assert report.measure[0] >= 0.3
    assert report.edge_mm[4] <= 1.6 * 0.6
    assert report.volume_ratio == pytest.approx(1.0, abs=0.005)
    assert report.measure_counts.sum() == report.cells
    assert len(report.worst_mm) == 8


@pytest.mark.parametrize("family", [*HEX_FAMILIES, "digitac", "tentacle"])
def test_regions_keep_their_area(family: str, default_solid: Built, coarse: Meshed) -> None:
    """Every region of both skins has the area of the CAD tessellation's."""
    error, where = worst_area_error(default_solid(family).membrane, coarse(family))
    # 0.6 mm cells on a border that follows no edge: half a cell of 10 mm, averaged along it.
    assert error < 0.015, where


@pytest.mark.parametrize("family", [*HEX_FAMILIES, "digitac", "tentacle"])
def test_skins_point_out_of_the_sensor(family: str, default_solid: Built, coarse: Meshed) -> None:
    """The camera's place is inside all three skins, a point beside the sensor in none."""
    solid, meshes = default_solid(family), coarse(family)
    low, high = solid.support.points_mm.min(axis=0), solid.support.points_mm.max(axis=0)
    camera = np.array([[0.0, 0.0, max(low[2], 0.0) + 0.2 * (high[2] - max(low[2], 0.0))]])
    beside = camera + np.array([3.0 * (high[0] - low[0]), 0.0, 0.0])
    for name in ("outer", "inner", "cavity"):
        skin = getattr(meshes, name)
        assert inside(skin, camera)[0], name
        assert not inside(skin, beside)[0], name
        assert np.linalg.norm(skin.normals, axis=1) == pytest.approx(1.0)
    cavity = meshes.cavity
    ends = free_ends(cavity)
    assert np.abs(cavity.points_mm[ends, 2]).max() < 1e-6
    corners = cavity.points_mm[cavity.faces]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    # The longest edges after remeshing are a few per cent over what is asked for.
    assert edges.max() <= 1.1


def free_ends(skin: Skin) -> np.ndarray:
    """Vertices on open edges."""
    ends = np.sort(np.stack([skin.faces, np.roll(skin.faces, -1, axis=1)], axis=-1), axis=-1)
    edges, count = np.unique(ends.reshape(-1, 2), axis=0, return_counts=True)
    return np.unique(edges[count == 1])


def test_skins_of_a_body_without_hexahedra_lie_on_it(default_solid: Built, coarse: Meshed) -> None:
    """Remeshed vertices lie on the source; edges near h; tips and backing come along."""
    solid, meshes = default_solid("digitac"), coarse("digitac")
    pins = meshes.inner.labels & Label.PIN != 0
    corners = meshes.inner.points_mm[meshes.inner.faces[~pins]]
    edges = np.linalg.norm(corners - np.roll(corners, 1, axis=1), axis=2)
    low, middle, high = np.percentile(edges, [5.0, 50.0, 95.0]) / 0.6
    # Around the pins edges shrink to theirs, an eighteenth of the root of their area.
    assert 0.15 < low
    assert 0.9 < middle < 1.15
    assert high < 1.4
    assert len(meshes.tips_mm) == len(np.unique(meshes.inner.numbers)) - 1
    assert np.array_equal(meshes.tips_mm, solid.tips_mm)
    assert meshes.backing_mm == solid.backing_mm > 0.0


def test_pad_is_closed_by_its_two_skins(default_solid: Built, coarse: Meshed) -> None:
    """Bonded face and sensing side, with its free sides, are a closed surface of the pad's volume.

    The inner skin points out of the sensor, so into the gel: turned, it closes the other.
    """
    hexes, meshes = hexahedra(coarse("pad")), coarse("pad")
    outer_nodes = np.flatnonzero(hexes.labels & Label.OUTER)
    inner_nodes = np.flatnonzero(hexes.labels & Label.INNER)
    faces = np.concatenate(
        [outer_nodes[meshes.outer.faces], inner_nodes[meshes.inner.faces][:, ::-1]]
    )
    assert is_watertight(faces)
    # Flat sides and a spherical dome of radius 100 mm: chords of 0.6 mm lose little.
    ratio = mesh_volume(hexes.points_mm, faces) / default_solid("pad").volume_mm3
    assert ratio == pytest.approx(1.0, abs=2e-3)
    assert not (hexes.labels & Label.BASE).any()


def test_nodes_of_an_actuator_carry_its_number(coarse: Meshed) -> None:
    """The nodes of each driven part of the trunk are the vertices of the faces labelled so.

    Where the top of a lobe meets its back, the higher number has the nodes.
    """
    hexes, outer = hexahedra(coarse("trunk")), coarse("trunk").outer
    nodes = np.flatnonzero(hexes.labels & Label.OUTER)
    faces = region_masks(outer.labels, outer.numbers)
    marked = region_masks(hexes.labels, hexes.numbers)
    for top, back in (("actuator_0", "actuator_2"), ("actuator_1", "actuator_3")):
        upper, lower = (np.unique(outer.faces[faces[name]]) for name in (top, back))
        assert len(np.intersect1d(upper, lower)) > 3
        assert np.array_equal(nodes[lower], np.flatnonzero(marked[back]))
        assert np.array_equal(nodes[np.setdiff1d(upper, lower)], np.flatnonzero(marked[top]))


def test_pins_own_the_material_points_inside_them(default_solid: Built) -> None:
    """Points of a pin fill its volume: the hull of its faces; far points carry no label."""
    membrane = default_solid("digitac").membrane
    points = material_points(membrane, 0.25)
    masks = region_masks(points.labels, points.numbers)
    areas = face_areas(membrane.points_mm, membrane.faces)
    pin = (membrane.labels & Label.PIN != 0) & (membrane.numbers == 3)
    hull_mm3 = ConvexHull(membrane.points_mm[np.unique(membrane.faces[pin])]).volume
    filled = points.fractions[masks["pin_3"]].sum(dtype=np.float64) * points.grid_mm**3 / 8
    # Points beside the pin's faces count too: at most one sub-cell of 0.125 mm around it.
    assert hull_mm3 * 0.97 < filled < hull_mm3 + areas[pin].sum() * 0.2
    thick = material_points(default_solid("finger").membrane, 0.4)
    assert (thick.labels[thick.fractions > 0.0] == 0).mean() > 0.3


def test_quality_of_known_triangles_and_tetrahedra() -> None:
    """A regular tetrahedron 1, mirrored -1; a right isosceles triangle has 45 degrees."""
    points = np.array([[1.0, 1, 1], [-1, -1, 1], [-1, 1, -1], [1, -1, -1]])
    cell = np.array([[0, 1, 2, 3]])
    sign = np.sign(np.linalg.det(points[1:] - points[0]))
    assert tetrahedron_quality(points, cell)[0] == pytest.approx(sign)
    assert tetrahedron_quality(points, cell[:, [0, 2, 1, 3]])[0] == pytest.approx(-sign)
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    skin = Skin(points_mm=corner, faces=np.array([[0, 1, 2]]), normals=np.zeros((3, 3)))
    report = skin_quality(skin)
    assert report.measure[0] == pytest.approx(45.0)
    assert report.edge_mm[-1] == pytest.approx(2.0**0.5)
    assert np.array_equal(report.worst_mm, corner)


@pytest.mark.slow
def test_hexahedra_lattice_and_tetrahedra_agree(finger: Solid, finger_mesh: MembraneMesh) -> None:
    """Three ways to divide the finger: one volume, to half a per cent of the CAD kernel's."""
    tets = tetrahedra(finger, 1.5)
    points = material_points(finger.membrane, 0.5)
    assert finger_mesh.hexes is not None
    for volume_mm3 in (finger_mesh.hexes.volume_mm3, points.volume_mm3, tets.volume_mm3):
        assert volume_mm3 == pytest.approx(finger.volume_mm3, rel=0.005)
    assert tets.quality.min() > 0.0
    faces = boundary_faces(tets.cells)
    assert is_watertight(faces)
    assert mesh_volume(tets.points_mm, faces) == pytest.approx(tets.volume_mm3, rel=1e-9)
    surface = np.zeros(len(tets.points_mm), dtype=bool)
    surface[faces] = True
    assert np.array_equal(tets.labels != 0, surface)
