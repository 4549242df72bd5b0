"""Faces with their contact points, and cutting a body out of a membrane."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.fem.body import face_weights, make_faces
from sim.fem.studies.blocks import flat_membrane, irregular_block
from sim.fem.submodel import Part, Submodel, boundary, cut_out
from workbench.core.base.errors import MeshingError
from workbench.core.design.design import Elastomer
from workbench.core.press.press import Press
from workbench.core.result.results import MembraneMesh

TOP_MM = np.array([0.0, 0.0, 2.0])


def cut(mesh: MembraneMesh, radius_mm: float = 3.0, *, backing_MPa: float = 0.02) -> Submodel:
    part = Part(centre_mm=TOP_MM, radius_mm=radius_mm)
    return cut_out(mesh, Elastomer(backing_MPa=backing_MPa), Press(target_mm=(0, 0, 2)), part)


def test_weights_of_a_face_sum_to_one() -> None:
    np.testing.assert_allclose(face_weights().sum(axis=1), 1.0, atol=1e-15)


def test_boundary_of_a_block_is_closed_and_looks_outward() -> None:
    """The area vectors of a closed surface sum to nothing; by Gauss they hold its volume."""
    points_mm, cells = irregular_block()
    quads = boundary(cells)
    assert len(quads) == 6 * 9
    corners = points_mm[quads]
    area = 0.5 * np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    np.testing.assert_allclose(area.sum(axis=0), 0.0, atol=1e-14)
    volume = np.einsum("qi,qi->", corners.mean(axis=1), area) / 3.0
    assert volume == pytest.approx(1.0, rel=1e-12)


def test_areas_of_a_plane_quadrilateral_are_exact() -> None:
    """A trapezium of 2 and 4 by 3 has 9 mm2."""
    points_mm = np.array([[0.0, 0, 0], [4, 0, 0], [3, 3, 0], [1, 3, 0]])
    faces = make_faces(points_mm, np.array([[0, 1, 2, 3]]))
    assert faces.areas_mm2.sum() == pytest.approx(9.0, rel=1e-12)
    # Its centroid is 4/3 high.
    places_mm = faces.places(points_mm)
    assert faces.areas_mm2.ravel() @ places_mm[:, 1] == pytest.approx(9.0 * 4.0 / 3.0, rel=1e-12)


def test_nodal_forces_have_the_resultant_of_the_traction() -> None:
    """Force and moment of any traction at the points are those of the nodal forces."""
    points_mm, cells = irregular_block()
    faces = make_faces(points_mm, boundary(cells))
    traction = np.random.default_rng(0).normal(size=(*faces.areas_mm2.shape, 3))
    pull_N = (traction * faces.areas_mm2[..., None]).reshape(-1, 3)
    nodal_N = faces.forces(traction).reshape(-1, 3)
    corners_mm = points_mm[faces.nodes].reshape(-1, 3)
    np.testing.assert_allclose(nodal_N.sum(axis=0), pull_N.sum(axis=0), atol=1e-13)
    np.testing.assert_allclose(
        np.cross(corners_mm, nodal_N).sum(axis=0),
        np.cross(faces.places(points_mm), pull_N).sum(axis=0),
        atol=1e-13,
    )


def test_stiffness_of_springs_is_that_of_their_forces() -> None:
    """K u are the nodal forces of the tractions k u at the points, for unsymmetric k too."""
    points_mm, cells = irregular_block()
    faces = make_faces(points_mm, boundary(cells))
    rng = np.random.default_rng(1)
    moduli = rng.normal(size=(*faces.areas_mm2.shape, 3, 3))
    moved_mm = rng.normal(size=points_mm.shape)
    there = faces.places(moved_mm).reshape(*faces.areas_mm2.shape, 3)
    known = faces.forces(np.einsum("qpij,qpj->qpi", moduli, there))
    found = np.einsum("qij,qj->qi", faces.stiffness(moduli), moved_mm[faces.nodes].reshape(-1, 12))
    np.testing.assert_allclose(found, known, atol=1e-14)


def test_the_cut_holds_what_goes_on_beyond_it() -> None:
    """Free nodes have all their cells inside; the bonded face is held, the skin is not."""
    mesh = flat_membrane(width_mm=10.0)
    found, hexes = cut(mesh), mesh.hexes
    assert hexes is not None
    body = found.body
    away_mm = np.linalg.norm(hexes.points_mm[hexes.cells].mean(axis=1) - TOP_MM, axis=1)
    assert len(body.elements.cells) == np.count_nonzero(away_mm < 3.0)
    beyond = np.unique(hexes.cells[away_mm >= 3.0])
    np.testing.assert_array_equal(found.marks.cut, np.isin(found.nodes, beyond))
    on_base = body.points_mm[:, 2] == 0.0
    np.testing.assert_array_equal(body.held, found.marks.cut | on_base)
    np.testing.assert_array_equal(found.marks.outer >= 0, body.points_mm[:, 2] == 2.0)
    np.testing.assert_array_equal(found.marks.inner >= 0, on_base)
    np.testing.assert_array_equal(
        mesh.outer.points_mm[found.marks.outer[found.marks.outer >= 0]],
        body.points_mm[found.marks.outer >= 0],
    )


def test_contact_faces_lie_on_the_skin_and_look_outward() -> None:
    body = cut(flat_membrane(width_mm=10.0)).body
    corners = body.points_mm[body.faces.nodes]
    assert (corners[..., 2] == 2.0).all()
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    assert (normal[:, 2] > 0.0).all()
    assert not body.held[body.faces.nodes].all(axis=1).any()


def test_without_a_radius_all_of_it_takes_part() -> None:
    mesh = flat_membrane()
    found = cut(mesh, np.inf)
    assert mesh.hexes is not None
    assert len(found.body.elements.cells) == len(mesh.hexes.cells)
    assert not found.marks.cut.any()


def test_gel_is_a_spring_per_area_and_softer_sideways() -> None:
    """Moved by 1 mm along Z, the backed area pushes E / gap per mm2; sideways a third of it."""
    body = cut(flat_membrane(gap_mm=4.0), np.inf, backing_MPa=0.02).body
    area_mm2 = body.springs.areas_mm2.sum()
    assert area_mm2 == pytest.approx(36.0, rel=1e-12)
    for axis, share in ((2, 1.0), (0, 1.0 / 3.0)):
        moved_mm = np.zeros_like(body.points_mm)
        moved_mm[:, axis] = 1.0
        force_N, energy_Nmm = body.spring_forces(moved_mm)
        push_N = share * 0.02 / 4.0 * area_mm2
        np.testing.assert_allclose(force_N.sum(axis=0), -push_N * np.eye(3)[axis], atol=1e-14)
        assert energy_Nmm == pytest.approx(0.5 * push_N, rel=1e-12)


def test_above_a_gap_only_the_rim_is_held_and_air_has_no_springs() -> None:
    body = cut(flat_membrane(gap_mm=4.0), np.inf, backing_MPa=0.0).body
    assert not len(body.springs.nodes)
    assert body.held.any()
    rim = (body.points_mm[:, 2] == 0.0) & (np.abs(body.points_mm[:, :2]).max(axis=1) >= 3.0)
    np.testing.assert_array_equal(body.held, rim)


def test_a_membrane_without_hexahedra_is_refused() -> None:
    mesh = dataclasses.replace(flat_membrane(), hexes=None, notice="it has pins")
    with pytest.raises(MeshingError, match="it has pins") as caught:
        cut(mesh)
    assert "source mpm" in caught.value.hint


def test_a_radius_that_holds_no_cell_is_refused() -> None:
    with pytest.raises(MeshingError, match=r"no hexahedron lies within 0\.1 mm"):
        cut(flat_membrane(), 0.1)
