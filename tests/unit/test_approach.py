"""Targets, first touch and the path of the indenter."""

import numpy as np
import pytest

from sim.contact.motion.approach import plan_approach
from sim.contact.motion.touch import first_touch
from sim.contact.objects.collider import make_collider
from sim.contact.studies.finger import at_45_degrees
from sim.contact.studies.specimens import finger, flat_block
from workbench.core.base.errors import DesignError
from workbench.core.base.frames import quaternion
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import Press
from workbench.core.result.results import Skin

BLOCK, _ = flat_block(width_mm=16.0, height_mm=4.0, grid_mm=1.0)
FINGER, _ = finger(grid_mm=2.0, cylinder_mm=27.0)


def touch_on_block(indenter: Indenter) -> float:
    collider = make_collider(indenter, grid_mm=0.5)
    press = Press(target_mm=(0.13, -0.07, 4.0))
    return plan_approach(BLOCK.outer, collider, press).touch_mm


@pytest.mark.parametrize(
    ("kind", "height_mm"),
    [
        (IndenterKind.SPHERE, 3.0),
        (IndenterKind.CYLINDER_END, 3.0),
        (IndenterKind.CYLINDER_SIDE, 3.0),
        (IndenterKind.CUBE, 3.0),
        (IndenterKind.CONE, 1.5 - 0.45 * (2**0.5 - 1)),
    ],
)
def test_first_touch_of_a_flat_skin_is_the_half_height(
    kind: IndenterKind, height_mm: float
) -> None:
    """The origin stands at the body's half height; the limit is the brief's 1e-3 mm."""
    assert touch_on_block(Indenter(kind=kind)) == pytest.approx(height_mm, abs=1e-3)


def test_sphere_touches_the_finger_at_its_radius() -> None:
    """R 3 on R 15 touches with the centre 3 mm out; 0.4 mm facets sag by 0.4^2 / 8 / 15 mm."""
    collider = make_collider(Indenter(), grid_mm=0.5)
    approach = plan_approach(FINGER.outer, collider, at_45_degrees(azimuth_deg=37.0))
    sag_mm = 0.4**2 * 2 / 8 / 15
    assert approach.touch_mm == pytest.approx(3.0, abs=2 * sag_mm)


@pytest.mark.parametrize("azimuth_deg", [0.0, 90.0])
def test_the_press_at_45_degrees_is_one_step_of_a_millimetre(azimuth_deg: float) -> None:
    """On the ball of radius 15 about (0, 0, 27), as far aside as upward: 15 / sqrt 2."""
    press = at_45_degrees(azimuth_deg=azimuth_deg)
    assert (press.frames, press.depth_mm) == (1, 1.0)
    way = np.array(press.target_mm) - [0.0, 0.0, 27.0]
    aside = [1.0, 0.0] if azimuth_deg == 0.0 else [0.0, 1.0]
    assert way == pytest.approx(np.array([*aside, 1.0]) * 15.0 / np.sqrt(2.0), abs=1e-12)


def test_target_is_projected_and_its_normal_is_smooth() -> None:
    """(0, 10, 35) lies on the ray to (0, 10, 8) / 12.81 from the centre of the tip."""
    approach = plan_approach(FINGER.outer, make_collider(Indenter(), grid_mm=0.5), Press())
    exact = np.array([0.0, 10.0, 8.0]) / np.hypot(10.0, 8.0)
    # A facet of 0.4 mm turns by 0.4 / 15 rad; interpolation leaves a small part of it.
    np.testing.assert_allclose(approach.normal, exact, atol=2e-3)
    np.testing.assert_allclose(approach.tangent_u @ approach.normal, 0.0, atol=1e-12)
    assert approach.tangent_u[2] > 0.7


def test_target_far_from_the_skin_is_refused() -> None:
    """10 mm above the skin: value, limit and the nearest point are in the message."""
    collider = make_collider(Indenter(), grid_mm=0.5)
    with pytest.raises(DesignError, match=r"is 10\.0 mm from the skin; the limit is 5 mm") as bad:
        plan_approach(BLOCK.outer, collider, Press(target_mm=(0.0, 0.0, 14.0)))
    assert bad.value.at == "press.target_mm"
    assert "4.0" in bad.value.hint


def test_tangent_falls_back_to_x_on_top() -> None:
    """Where n is +Z, U is +X and V is +Y."""
    collider = make_collider(Indenter(), grid_mm=0.5)
    approach = plan_approach(BLOCK.outer, collider, Press(target_mm=(0.0, 0.0, 4.0)))
    np.testing.assert_allclose(approach.tangent_u, [1.0, 0.0, 0.0], atol=1e-12)
    np.testing.assert_allclose(approach.tangent_v, [0.0, 1.0, 0.0], atol=1e-12)


def test_path_presses_then_shears_and_twists() -> None:
    """Depth after 5 of 10 frames is half; the last pose has all of the shear and the twist."""
    collider = make_collider(Indenter(), grid_mm=0.5)
    press = Press(target_mm=(0.0, 0.0, 4.0), shear_mm=(0.2, -0.1), twist_deg=30.0, frames=10)
    approach = plan_approach(BLOCK.outer, collider, press)
    half, _ = approach.pose(5.0)
    np.testing.assert_allclose(half, [0.0, 0.0, 7.0 - 0.5], atol=1e-3)
    origin, rotation = approach.pose(20.0)
    np.testing.assert_allclose(origin, [0.2, -0.1, 6.0], atol=1e-3)
    np.testing.assert_allclose(
        quaternion(rotation), [np.cos(np.pi / 12), 0.0, 0.0, np.sin(np.pi / 12)], atol=1e-12
    )


def test_object_that_passes_beside_the_skin_is_refused() -> None:
    """A ball 1 mm beside the edge of a block 16 mm wide never touches, near or far."""
    collider = make_collider(Indenter(), grid_mm=0.5)
    for beside_mm in (4.0, 40.0):
        target = np.array([8.0 + beside_mm, 0.0, 4.0])
        with pytest.raises(DesignError, match="passes beside the skin") as raised:
            first_touch(BLOCK.outer, collider, target, np.eye(3))
        assert raised.value.at == "press.target_mm"


def test_object_that_meets_an_overhang_first_is_refused() -> None:
    """A plate 20 mm above the target and 2 mm aside stops the ball; the limit is 3 + 3 mm."""
    plate = BLOCK.outer.points_mm * [0.1, 0.1, 0.0] + [2.0, 0.0, 24.0]
    both = Skin(
        points_mm=np.vstack([BLOCK.outer.points_mm, plate]),
        faces=np.vstack([BLOCK.outer.faces, BLOCK.outer.faces + len(plate)]),
        normals=np.vstack([BLOCK.outer.normals] * 2),
    )
    collider = make_collider(Indenter(), grid_mm=0.5)
    with pytest.raises(DesignError, match=r"elsewhere first, 20\..* limit is 6\.0 mm") as raised:
        plan_approach(both, collider, Press(target_mm=(0.0, 0.0, 4.0)))
    assert raised.value.at == "press.target_mm"


def test_poses_at_once_are_those_one_by_one() -> None:
    """A press that shears and twists, within its frames and beyond them."""
    collider = make_collider(Indenter(), grid_mm=0.5)
    press = Press(
        target_mm=(0.13, -0.07, 4.0), depth_mm=0.5, frames=2, shear_mm=(0.3, -0.2), twist_deg=30.0
    )
    approach = plan_approach(BLOCK.outer, collider, press)
    progress = np.linspace(0.0, 5.0, 21)
    origins, turned = approach.poses(progress)
    for at, origin, rotation in zip(progress, origins, turned, strict=True):
        one, turn = approach.pose(float(at))
        np.testing.assert_array_equal(one, origin)
        np.testing.assert_array_equal(turn, rotation)
    np.testing.assert_allclose(
        turned @ turned.swapaxes(1, 2), np.tile(np.eye(3), (21, 1, 1)), atol=1e-12
    )
    way = origins[16] - origins[0]
    shift = 0.3 * approach.tangent_u - 0.2 * approach.tangent_v
    np.testing.assert_allclose(way, shift - 0.5 * approach.normal, atol=1e-12)
    # 30 degrees about the normal, all of them by the end of the fourth frame.
    assert np.trace(turned[0].T @ turned[-1]) == pytest.approx(1.0 + 3.0**0.5)
