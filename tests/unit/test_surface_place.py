"""The place of a skin nearest to a point: on triangles, with the normal of what they stand for."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import trimesh

from geometry.surface.surface import vertex_normals
from geometry.surface.surface_place import place_near
from ui.desk.aiming import Aiming
from ui.scene.object_view import ObjectView
from ui.scene.sensor import SensorView
from workbench.core.design.design import SensorDesign
from workbench.core.press.press import Press
from workbench.core.result.results import Skin, Solid
from workbench.live.object_drawing import Drawing
from workbench.project.aim import sensing_skin, skin_place, target_notice

BOX = trimesh.creation.box((20.0, 20.0, 60.0))


@pytest.mark.parametrize("z_mm", [0.0, 17.0, 29.5])
def test_the_nearest_place_of_a_long_wall_is_beside_the_point(z_mm: float) -> None:
    """1 mm before the wall x = 10 of a box of 12 triangles: (10, y, z), 1 mm away, normal +X."""
    place = place_near(np.asarray(BOX.vertices), np.asarray(BOX.faces), np.array([11.0, 3.0, z_mm]))
    assert place.point_mm == pytest.approx([10.0, 3.0, z_mm], abs=1e-12)
    assert place.distance_mm == pytest.approx(1.0)
    # Half a millimetre from the edge too: the end face meets it at 90 degrees.
    assert place.normal == pytest.approx([1.0, 0.0, 0.0], abs=1e-9)


def test_normal_turns_evenly_on_a_curved_skin() -> None:
    """On a ball of 8 mm and 1280 triangles the normal is radial within 0.8 degrees."""
    ball = trimesh.creation.icosphere(subdivisions=3, radius=8.0)
    rng = np.random.default_rng(0)
    for way in rng.normal(size=(40, 3)):
        place = place_near(np.asarray(ball.vertices), np.asarray(ball.faces), 20.0 * way)
        radial = place.point_mm / np.linalg.norm(place.point_mm)
        # Facets of a twelfth of the radius stand up to 3 degrees off; their blend hardly at all.
        assert np.degrees(np.arccos(min(1.0, place.normal @ radial))) < 0.8


def aiming_at(solid: Solid, target_mm: tuple[float, float, float]) -> Any:
    """A desk that shows a body and aims at a target; it remembers what it is amended to."""
    nothing = SimpleNamespace(
        put=lambda *words: None, keep=lambda *words: None, dim=lambda dimmed: None
    )
    view = SensorView(SimpleNamespace(), lambda event: None)
    view.skin = view.inside = view.support = view.foot = nothing  # pyright: ignore[reportAttributeAccessIssue]
    view.show = lambda visible: None
    view.show_solid(solid)
    desk: Any = SimpleNamespace(scene=SimpleNamespace(body=view), amended=lambda words: None)
    case = SimpleNamespace(press=Press(target_mm=target_mm))
    design = SensorDesign(name="finger")
    desk.aims = []
    desk.session = SimpleNamespace(
        case=case, design=design, amend=lambda path, value: desk.aims.append(value)
    )
    return desk


def test_a_target_typed_on_a_straight_wall_stays(build_finger: Callable[..., Solid]) -> None:
    """Finger of radius 10 and 27 mm of wall, target 0, 10, 18: it went to 0.3, 10, 27."""
    solid = build_finger(outer_radius_mm=10.0)
    desk = aiming_at(solid, (0.0, 10.0, 18.0))
    Aiming(desk).keep_aim()
    assert desk.aims == []
    place = skin_place(sensing_skin(solid), (0.0, 10.0, 18.0))
    # The chord of a facet lies below the wall by its sagitta.
    assert place.distance_mm < 0.02
    assert place.normal == pytest.approx([0.0, 1.0, 0.0], abs=0.01)


def test_the_object_stands_at_a_target_on_a_wall(build_finger: Callable[..., Solid]) -> None:
    """An object that reaches 3 mm below its middle stands 3 mm before the target."""
    desk = aiming_at(build_finger(outer_radius_mm=10.0), (0.0, 10.0, 18.0))
    view = ObjectView(None, desk.scene.body)
    view._draw = lambda: None
    empty = np.zeros((0, 3))
    view.show(Drawing(points_mm=empty, faces=empty, lowest_mm=3.0), desk.session.case.press)
    assert view.standing[:3] == pytest.approx([0.0, 13.0, 18.0], abs=0.05)


def test_a_target_left_in_the_air_still_follows(build_finger: Callable[..., Solid]) -> None:
    """At 0, 16, 18 it is 6 mm off a finger of radius 10, which the solver refuses: 0, 10, 18."""
    desk = aiming_at(build_finger(outer_radius_mm=10.0), (0.0, 16.0, 18.0))
    Aiming(desk).keep_aim()
    assert desk.aims[0] == pytest.approx((0.0, 10.0, 18.0), abs=0.02)


def test_a_chosen_target_well_off_the_skin_is_named(build_finger: Callable[..., Solid]) -> None:
    """2 mm off: said with the place that was used; where the family aims nothing is said."""
    solid, design = build_finger(outer_radius_mm=10.0), SensorDesign(name="finger")
    used: Any = SimpleNamespace(target_mm=np.array([0.0, 10.0, 18.0]))
    words = target_notice(design, solid, Press(target_mm=(0.0, 12.0, 18.0)), used)
    assert "2.0 mm off the skin" in words and "(0, 10, 18)" in words
    assert target_notice(design, solid, Press(target_mm=(0.0, 10.5, 18.0)), used) == ""
    assert target_notice(design, solid, Press(), used) == ""


def test_the_place_of_a_mesh_is_that_of_a_search_tree() -> None:
    """All triangles looked at, or those of a tree: the same place within rounding."""
    from geometry.surface.surface import closest_point

    ball = trimesh.creation.icosphere(subdivisions=2, radius=5.0)
    points, faces = np.asarray(ball.vertices), np.asarray(ball.faces)
    skin = Skin(points_mm=points, faces=faces, normals=vertex_normals(points, faces))
    query = np.random.default_rng(1).normal(scale=6.0, size=(20, 3))
    found, away_mm, _ = closest_point(skin.points_mm, skin.faces, query)
    for row, place in enumerate(query):
        one = place_near(points, faces, place)
        assert one.point_mm == pytest.approx(found[row], abs=1e-9)
        assert one.distance_mm == pytest.approx(away_mm[row], abs=1e-9)
