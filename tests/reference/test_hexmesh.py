"""Hexahedra and skins of the finger against its closed form."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from geometry.surface.surface import open_edges
from geometry.volume import checks
from geometry.volume.hexmesh import mesh_membrane
from geometry.volume.hexquality import hex_volumes, scaled_jacobian
from workbench.core.base.errors import MeshingError
from workbench.core.design.design import Layers, Meshing
from workbench.core.result.results import Label, MembraneMesh, Solid

UNIT = np.array(
    [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]], float
)
ONE = np.arange(8)[None]


def test_volume_and_quality_of_single_cells() -> None:
    """Box 2 x 3 x 4: 24 mm3 and 1. Sheared to 45 degrees: same volume, 1 / sqrt 2. Mirrored: -1."""
    box = UNIT * [2.0, 3.0, 4.0]
    assert hex_volumes(box, ONE)[0] == pytest.approx(24.0)
    assert scaled_jacobian(box, ONE)[0] == pytest.approx(1.0)
    sheared = UNIT + UNIT[:, [2]] * [1.0, 0.0, 0.0]
    assert hex_volumes(sheared, ONE)[0] == pytest.approx(1.0)
    assert scaled_jacobian(sheared, ONE)[0] == pytest.approx(0.5**0.5)
    assert scaled_jacobian(UNIT * [1.0, 1.0, -1.0], ONE)[0] == pytest.approx(-1.0)


def test_volume_of_a_twisted_cell_is_that_of_its_trilinear_map() -> None:
    """Against 2x2x2 Gauss points, which are exact for a trilinear map."""
    corners = UNIT + np.random.default_rng(0).uniform(-0.2, 0.2, (8, 3))
    signs = 2.0 * UNIT - 1.0
    volume = 0.0
    for gauss in signs / np.sqrt(3.0):
        terms = 1.0 + signs * gauss
        slopes = np.column_stack(
            [signs[:, k] * np.delete(terms, k, axis=1).prod(axis=1) for k in range(3)]
        )
        volume += np.linalg.det(corners.T @ slopes / 8.0)
    assert hex_volumes(corners, ONE)[0] == pytest.approx(volume, rel=1e-12)


def test_no_cell_is_inverted_and_volume_is_kept(finger: Solid, finger_mesh: MembraneMesh) -> None:
    """Scaled Jacobian of the cubed sphere is at least sin 120 degrees = 0.866; volume ratio 1."""
    hexes = finger_mesh.hexes
    assert hexes.layers == 5
    assert checks.hex_least_quality(hexes) > 0.85
    # Chords of 0.4 mm on a radius of 15 lose 3e-5, the rest is interpolation.
    assert checks.hex_volume_ratio(hexes, finger) == pytest.approx(1.0, abs=1e-3)
    assert set(np.unique(hexes.cells)) == set(range(len(hexes.points_mm)))


def test_skins_share_the_nodes_of_the_hexahedra(finger_mesh: MembraneMesh) -> None:
    """Outer skin = last sheet, inner = first, labels say so, base exactly at z = 0."""
    hexes = finger_mesh.hexes
    points, labels = hexes.points_mm, hexes.labels
    assert np.array_equal(points[(labels & Label.OUTER) > 0], finger_mesh.outer.points_mm)
    assert np.array_equal(points[(labels & Label.INNER) > 0], finger_mesh.inner.points_mm)
    assert (points[(labels & Label.BASE) > 0, 2] == 0.0).all()
    assert (points[(labels & Label.BASE) == 0, 2] > 0.0).all()
    rim = (labels & Label.BASE > 0) & (labels & Label.OUTER > 0)
    assert open_edges(finger_mesh.outer.faces) == np.count_nonzero(rim)


def test_skins_are_smooth_and_point_outward(finger_mesh: MembraneMesh) -> None:
    """Radii 15, 13 and 12 mm, normals radial; flat chords alone would turn by 2.9 degrees."""
    # Where cylinder meets cap the corner normals are a degree off: half a chord's bulge stays.
    for name, radius, limit_mm, turn_deg in (
        ("outer", 15.0, 0.006, 0.75),
        ("inner", 13.0, 0.006, 0.75),
        ("cavity", 12.0, 0.02, 2.3),
    ):
        skin = getattr(finger_mesh, name)
        error = checks.skin_radius_error_mm(skin, radius_mm=radius, cylinder_mm=27.0)
        assert error < limit_mm, name
        centre = skin.points_mm * [0.0, 0.0, 1.0]
        centre[:, 2] = np.minimum(centre[:, 2], 27.0)
        radial = skin.points_mm - centre
        cosine = np.einsum("ij,ij->i", radial, skin.normals) / np.linalg.norm(radial, axis=1)
        # A quarter of the turn that flat chords would leave; the cavity's chords are 0.16 rad.
        assert cosine.min() > np.cos(np.radians(turn_deg)), name


def test_edges_are_even(finger_mesh: MembraneMesh) -> None:
    """Sides of 0.4 mm to within 30 %, diagonals sqrt 2 of that; the cavity's below 1 mm."""
    points, faces = finger_mesh.outer.points_mm, finger_mesh.outer.faces
    edges = np.linalg.norm(points[faces] - np.roll(points[faces], 1, axis=1), axis=2)
    assert edges.min() > 0.28 * 0.99
    assert edges.max() < 0.4 * 1.5
    cavity = finger_mesh.cavity
    corner = cavity.points_mm[cavity.faces]
    assert np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max() <= 1.0


def test_layers_follow_the_wall(build_finger: Callable[..., Solid]) -> None:
    """Wall 0.8 mm at 0.8 mm: two layers all the same; 3 mm at 0.6 mm: five."""
    for wall_mm, hex_mm, layers in ((0.8, 0.8, 2), (3.0, 0.6, 5)):
        solid = build_finger(Layers(elastomer_mm=wall_mm), cylinder_mm=5.0)
        assert mesh_membrane(solid, Meshing(hex_mm=hex_mm)).hexes.layers == layers


def test_a_wall_that_cannot_be_seen_whole_gets_skins_alone(finger: Solid) -> None:
    """A finger with part of its outer face missing stops rays; one without, is refused."""
    surface = finger.membrane
    labels = surface.labels.copy()
    high = surface.points_mm[surface.faces, 2].min(axis=1) > 35.0
    labels[high & (labels == Label.OUTER)] = Label.BASE
    broken = dataclasses.replace(finger, membrane=dataclasses.replace(surface, labels=labels))
    mesh = mesh_membrane(broken, Meshing(hex_mm=1.0))
    assert mesh.hexes is None
    assert "rays from inside miss the wall" in mesh.notice
    # The missing part lies above 35 mm; its triangles reach a little lower.
    assert 34.0 < mesh.outer.points_mm[:, 2].max() < 36.0
    none = dataclasses.replace(surface, labels=np.full_like(labels, Label.BASE))
    with pytest.raises(MeshingError, match="no OUTER face"):
        mesh_membrane(dataclasses.replace(finger, membrane=none), Meshing())
