"""An object that is turned: angles, extent and distance of every kind, and keys that stay."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
import trimesh
from hypothesis import given
from hypothesis import strategies as st

from sim.contact.objects.collider import make_collider
from sim.contact.objects.object_measures import exact_distance, lowest_mm
from sim.contact.objects.sampling import box_mm
from workbench.cli.command_line import parser
from workbench.cli.groups.dataset_make import chosen_recipe
from workbench.core.base.digest import digest
from workbench.core.base.errors import DesignError
from workbench.core.design.turning import touching_with, turn_angles, turn_matrix
from workbench.core.objects.kind import Shape
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.texture import Pattern, Texture
from workbench.learning.dataset.recipes import load_recipe, recipe_from_toml, recipe_to_toml
from workbench.live.indenter_display import display_mesh
from workbench.project.kept_indenters import indenter_table, read_indenter
from workbench.project.project import Project

KINDS = [kind for kind in IndenterKind if kind is not IndenterKind.MESH]
ODD = (25.0, -40.0, 70.0)
ANGLE = st.floats(-180.0, 180.0)


def test_turns_are_about_fixed_axes_in_order() -> None:
    """X by 90 takes Y to Z; then Z by 90 leaves that Z and takes X to Y."""
    turn = turn_matrix((90.0, 0.0, 90.0))
    assert turn @ [0.0, 1.0, 0.0] == pytest.approx([0.0, 0.0, 1.0], abs=0.0)
    assert turn @ [1.0, 0.0, 0.0] == pytest.approx([0.0, 1.0, 0.0], abs=0.0)
    assert turn_matrix((180.0, 0.0, 0.0)) @ [1.0, 2.0, 3.0] == pytest.approx([1.0, -2.0, -3.0])


@given(ANGLE, st.one_of(ANGLE, st.sampled_from((90.0, -90.0))), ANGLE)
def test_angles_of_a_turn_give_it_back(x: float, y: float, z: float) -> None:
    """Also where Y turns by a quarter and X and Z are about one axis; to their decimals."""
    turn = turn_matrix((x, y, z))
    np.testing.assert_allclose(turn_matrix(turn_angles(turn)), turn, atol=6e-5)


@given(ANGLE, ANGLE, ANGLE, st.tuples(*[st.floats(-1.0, 1.0)] * 3))
def test_the_face_that_is_to_touch_looks_down(
    x: float, y: float, z: float, way: tuple[float, float, float]
) -> None:
    """Its normal, turned on, is -Z, to the decimals of the angles."""
    normal = np.array(way) + np.array([0.0, 0.0, 2.0])
    own = turn_matrix((x, y, z)).T @ normal / np.linalg.norm(normal)
    found = touching_with((x, y, z), normal)
    assert turn_matrix(found) @ own == pytest.approx([0.0, 0.0, -1.0], abs=1e-4)


def test_the_far_side_touches_after_half_a_turn_about_x() -> None:
    """What is up is down after 180, 0, 0."""
    assert touching_with((0.0, 0.0, 0.0), np.array([0.0, 0.0, 1.0])) == (180.0, 0.0, 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind_is_turned_as_its_drawing(kind: IndenterKind) -> None:
    """Vertices of the turned drawing: distance 0, the box exact, the lowest one `lowest_mm`."""
    indenter = Indenter(kind=kind, turn_deg=ODD)
    points, _ = display_mesh(dataclasses.replace(indenter, turn_deg=(0.0, 0.0, 0.0)))
    turned = points @ turn_matrix(ODD).T
    # Contoured drawings lie within hundredths of the surface.
    assert np.abs(exact_distance(indenter)(turned)).max() < 0.04
    low, high = box_mm(indenter)
    assert low == pytest.approx(turned.min(axis=0), abs=0.03)
    assert high == pytest.approx(turned.max(axis=0), abs=0.03)
    assert -lowest_mm(indenter) == pytest.approx(turned[:, 2].min(), abs=0.03)
    drawn, _ = display_mesh(indenter)
    assert drawn.min(axis=0) == pytest.approx(turned.min(axis=0), abs=0.03)


@pytest.mark.parametrize("kind", [IndenterKind.CUBE, IndenterKind.CONE, IndenterKind.FLOWER])
def test_contact_feels_the_turned_object(kind: IndenterKind) -> None:
    """The collider's distance is that of the object, asked at the place turned back."""
    here = make_collider(Indenter(kind=kind, turn_deg=ODD), grid_mm=0.5)
    places = np.random.default_rng(0).normal(scale=2.5, size=(200, 3))
    before = exact_distance(Indenter(kind=kind))(places @ turn_matrix(ODD))
    near = np.abs(before) < 0.8
    # Sampled at 0.2 mm: edges of 0.45 mm are held to a few hundredths.
    assert np.abs(here.distance(places[near])[0] - before[near]).max() < 0.05


def test_a_ball_stays_a_ball_and_needs_no_samples() -> None:
    """Every turn of a sphere is the sphere: the closed form stays."""
    collider = make_collider(Indenter(turn_deg=(10.0, 20.0, 30.0)), grid_mm=0.5)
    assert collider.shape is Shape.SPHERE


def wedge() -> IndenterMesh:
    """A pyramid, 8 x 8 mm and 6 mm high, its tip up."""
    corners = [[-4.0, -4, -3], [4, -4, -3], [4, 4, -3], [-4, 4, -3], [0, 0, 3]]
    mesh = trimesh.convex.convex_hull(np.array(corners))
    return IndenterMesh(points_mm=np.asarray(mesh.vertices), faces=np.asarray(mesh.faces))


@pytest.mark.usefixtures("taichi_device")
def test_a_turned_file_touches_with_its_other_side() -> None:
    """Over by half a turn the tip of a pyramid is down: 3 mm below the middle, on the axis."""
    indenter = Indenter(kind=IndenterKind.MESH, mesh=wedge(), turn_deg=(180.0, 0.0, 0.0))
    collider = make_collider(indenter, grid_mm=0.5)
    assert collider.half_height_mm == pytest.approx(3.0)
    tip, beside = collider.distance(np.array([[0.0, 0.0, -3.0], [3.5, 0.0, -2.9]]))[0]
    assert abs(tip) < 0.2
    assert beside > 1.0


def test_texture_and_holder_stay_where_the_skin_is_and_is_not() -> None:
    """On a cone that touches with its base the ridges are raised below, on the base."""
    smooth = Indenter(kind=IndenterKind.CONE, size_mm=12.0, turn_deg=(180.0, 0.0, 0.0))
    ridged = dataclasses.replace(
        smooth, texture=Texture(pattern=Pattern.WAVES, height_mm=0.3, pitch_mm=3.0)
    )
    soft = dataclasses.replace(smooth, soft=SoftBody())
    low, high = box_mm(smooth)
    assert box_mm(ridged)[0][2] == pytest.approx(low[2] - 0.3)
    assert box_mm(ridged)[1][2] == pytest.approx(high[2])
    assert box_mm(soft)[1][2] == pytest.approx(high[2])
    crest, valley = make_collider(ridged, grid_mm=0.5).distance(
        np.array([[3.0, 0.0, low[2] - 0.15], [1.5, 0.0, low[2] - 0.15]])
    )[0]
    assert crest < 0.0 < valley


def test_an_object_as_it_came_keeps_its_key() -> None:
    """Keys of before the field are valid: the digest of the same fields without it."""
    assert digest(Indenter(kind=IndenterKind.CUBE)) == "bf5036bd0b20cda67ee6bf4f75175baa"
    assert digest(Indenter()) != digest(Indenter(turn_deg=(180.0, 0.0, 0.0)))
    assert digest(Indenter(turn_deg=(0, 0, 0))) == digest(Indenter())


def test_a_recipe_of_objects_as_they_came_keeps_its_key() -> None:
    """The table that a data set's key is made of has the turn only where there is one."""
    recipe = load_recipe("tiny")
    assert "turn_deg" not in recipe.table
    words = ["dataset", "make", "tiny", "--out", "x", "--turn-deg", "90,0,-45"]
    turned = chosen_recipe(parser().parse_args(words), Project(None))
    assert turned.key != recipe.key
    assert turned.indenter(IndenterKind.CUBE).turn_deg == (90.0, 0.0, -45.0)
    assert recipe_from_toml(recipe_to_toml(turned)).turn_deg == turned.turn_deg


def test_a_turn_is_kept_in_the_design_file(tmp_path: Path) -> None:
    """Of a shape and of a mesh, there and back; a table without it is an object as it came."""
    project = Project(tmp_path)
    for indenter in (
        Indenter(kind=IndenterKind.CUBE, turn_deg=ODD),
        Indenter(kind=IndenterKind.MESH, mesh=wedge(), turn_deg=ODD),
    ):
        table = indenter_table(indenter, project)
        assert read_indenter(table, project).turn_deg == ODD
        del table["turn_deg"]
        assert not read_indenter(table, project).turned


def test_a_turn_beyond_the_circle_is_refused() -> None:
    """400 degrees name the limit; two angles are too few."""
    with pytest.raises(DesignError, match="360"):
        Indenter(turn_deg=(400.0, 0.0, 0.0))
