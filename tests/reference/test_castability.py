"""Measures of castability against shapes whose answer is known."""

from __future__ import annotations

import numpy as np
import pytest

from geometry.body import csg
from geometry.body.csg_brep import checked
from geometry.body.csg_mesh import arrays, evaluate, overlaps_mm3
from geometry.body.silicones import SILICONES, doubled_MPa, gent_MPa, nearest, silicone
from geometry.mould.cast import Cast
from geometry.mould.castability import bed_ratio, draft_deg, removal_strain, undercut
from geometry.mould.core_release import core_strain
from geometry.mould.trapped import pockets
from geometry.surface.primitives import sphere
from geometry.surface.spread import spread
from workbench.core.base.errors import DesignError, GeometryError

UP = np.array([0.0, 0.0, 1.0])


def body(node: csg.Node) -> csg.Body:
    points, faces = arrays(evaluate(node))
    return csg.Body(points_mm=points, faces=faces)


def as_cast(node: csg.Node) -> Cast:
    outer = body(node)
    return Cast(outer=outer, core=None, base_mm=0.0, sensing=outer, loops_mm=())


def test_half_a_sphere_has_no_undercut() -> None:
    """Its upper half pulled up: 0."""
    points, faces = sphere(10.0)
    places = spread(points, faces)
    upper = places.points_mm[:, 2] > 0.0
    part = places._replace(points_mm=places.points_mm[upper], normals=places.normals[upper])
    assert undercut(points, faces, UP, part).value == 0.0


def test_undercut_of_a_mushroom() -> None:
    """Pulled up: stem's side and cap's underside are held, (2 r h + R^2 - r^2) of the area."""
    stem, cap, height, thick = 3.0, 6.0, 8.0, 2.0
    mushroom = body(
        csg.Union(parts=(csg.cylinder(stem, 0, height), csg.cylinder(cap, height, height + thick)))
    )
    places = spread(mushroom.points_mm, mushroom.faces, 20000)
    above = places.points_mm[:, 2] > 1e-6
    part = places._replace(points_mm=places.points_mm[above], normals=places.normals[above])
    held = 2.0 * stem * height + cap**2 - stem**2
    whole = held + 2.0 * cap * thick + cap**2
    # 20000 places, and the last 0.1 mm under the rim is no undercut: 2 % of the underside.
    found = undercut(mushroom.points_mm, mushroom.faces, UP, part)
    assert found.value == pytest.approx(held / whole, abs=0.015)
    assert found.place_mm[2] == pytest.approx(height)


def test_draft_of_a_cone_is_its_half_angle() -> None:
    """Radius 10 to 5 over 20 mm: atan(1 / 4) = 14.04 degrees."""
    cone = body(csg.Cone(low_radius_mm=10, high_radius_mm=5, low_mm=0, high_mm=20))
    places = spread(cone.points_mm, cone.faces)
    upright = np.abs(places.normals[:, 2]) < 0.9
    part = places._replace(points_mm=places.points_mm[upright], normals=places.normals[upright])
    # Facets of a 64-gon are steeper than the cone by 0.1 % at most.
    assert draft_deg(part, UP).value == pytest.approx(np.degrees(np.arctan(0.25)), abs=0.05)


def test_air_under_an_inverted_cup() -> None:
    """A knob hanging beside the foot traps air of its own height; a plain foot traps none."""
    foot = csg.cylinder(5.0, 0.0, 20.0)
    plate = csg.Box(low_mm=(0, -3, 15), high_mm=(20, 3, 20))
    knob = csg.Box(low_mm=(16, -2, 11), high_mm=(18, 2, 15.5))
    assert len(pockets(as_cast(foot)).places_mm) == 0
    found = pockets(as_cast(csg.Union(parts=(foot, plate, knob))))
    assert found.height_mm.tolist() == pytest.approx([4.0])
    assert found.places_mm[0, 2] == pytest.approx(11.0)


def test_bed_takes_the_best_orientation() -> None:
    """100 x 20 x 180 mm on a bed of 145 x 145 x 185: 180 / 185; 200 mm long: 200 / 185."""
    corners = np.array([[0.0, 0.0, 0.0], [180.0, 100.0, 20.0]])
    assert bed_ratio(corners, (145.0, 145.0, 185.0)) == pytest.approx(180.0 / 185.0)
    longer = corners * [200.0 / 180.0, 1.0, 1.0]
    assert bed_ratio(longer, (145.0, 145.0, 185.0)) == pytest.approx(200.0 / 185.0)


def test_core_removal_strain_of_a_bulb() -> None:
    """A ball of radius 8 on a neck of radius 5: 8 / 5 - 1 = 0.6; a plain cylinder 0."""
    neck = csg.cylinder(5.0, 0.0, 20.0)
    points, faces = sphere(8.0)
    ball = csg.moved(csg.Body(points_mm=points, faces=faces), (0.0, 0.0, 20.0))
    # Sections stand 0.5 mm apart, and the ball is a polyhedron.
    assert core_strain(body(csg.Union(parts=(neck, ball)))).value == pytest.approx(0.6, abs=0.01)
    assert core_strain(body(neck)).value == pytest.approx(0.0, abs=1e-9)
    found = removal_strain(np.array([0.0, 1.0, 2.0]), np.array([4.0, 2.0, 3.0]))
    assert found.value == pytest.approx(0.5)
    assert found.place_mm[2] == 2.0


def test_triangles_and_brep_of_a_description_agree() -> None:
    """A drilled, tilted box with a boss: the volume in closed form, to the circle's polygon."""
    drilled = csg.without(
        csg.Box(low_mm=(0, 0, 0), high_mm=(20, 20, 10)),
        [csg.moved(csg.cylinder(3.0, -1.0, 11.0), (10.0, 10.0, 0.0))],
    )
    node = csg.turned(csg.moved(drilled, (5.0, 0.0, 2.0)), 30.0)
    exact = 4000.0 - np.pi * 9.0 * 10.0
    assert checked(node, exact, what="box").volume == pytest.approx(exact, rel=1e-9)
    assert evaluate(node).volume() == pytest.approx(exact, rel=3e-4)
    with pytest.raises(GeometryError, match="by the CAD kernel has 1 solids"):
        checked(node, 1.01 * exact, what="box")


def test_overlap_of_shifted_boxes() -> None:
    """Two 2 mm cubes 1.5 mm apart share 0.5 x 2 x 2 = 2 mm3: the measure is not blind."""
    box = csg.Box(low_mm=(-1, -1, -1), high_mm=(1, 1, 1))
    solids = {"one": evaluate(box), "other": evaluate(csg.moved(box, (1.5, 0.0, 0.0)))}
    assert overlaps_mm3(solids) == {("one", "other"): pytest.approx(2.0)}


def test_moduli_of_silicones() -> None:
    """Gent: Shore 30A is 1.14 MPa by hand; 10 psi at 100 % strain is 12 / 7 * 0.0689 MPa."""
    by_hand = 0.0981 * (56.0 + 7.62336 * 30.0) / (0.137505 * (254.0 - 2.54 * 30.0))
    assert gent_MPa(30.0) == pytest.approx(by_hand)
    assert by_hand == pytest.approx(1.14, abs=0.01)
    assert doubled_MPa(10.0) == pytest.approx(0.1182, abs=1e-4)
    assert nearest(0.145).name == "XP-565 1:15"
    assert all(row.source and row.young_MPa > 0.0 for row in SILICONES.values())
    with pytest.raises(DesignError, match="no silicone 'chewing gum'"):
        silicone("chewing gum")
