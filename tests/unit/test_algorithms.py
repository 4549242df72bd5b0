"""Algorithms 1 and 2 of the paper, counted."""

import itertools

import numpy as np
import pytest

from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.studies.specimens import finger
from workbench.core.base.errors import DesignError
from workbench.core.press.indenter import Indenter
from workbench.learning.dataset.algorithms import finger_algorithm, finger_points_mm, pad_algorithm

SHAPES = 14
"""Indenters of the paper."""


def test_finger_has_85_contact_points_on_its_surface() -> None:
    """1 apex + 4 x (9 on the tip + 12 on the base), each once, at 15 mm from tip centre or axis."""
    points = np.array(finger_points_mm())
    assert points.shape == (85, 3)
    assert len(np.unique(points, axis=0)) == 85
    over = np.maximum(points[:, 2] - 27.0, 0.0)
    np.testing.assert_allclose(np.hypot(np.hypot(points[:, 0], points[:, 1]), over), 15.0)
    assert points[:, 2].max() == 42.0
    assert points[:, 2].min() == 15.0


def test_algorithm_1_has_the_states_of_its_grid() -> None:
    """14 x 85 x 10 = 11,900 normal states and 14 x 85 x 10 x 8 x 5 = 476,000 sheared ones."""
    normal, sheared = 0, 0
    for visit in finger_algorithm():
        states = len(visit.recorded)
        assert visit.recorded.stop == visit.press.frame_count
        normal += states if visit.direction is None else 0
        sheared += states if visit.direction is not None else 0
    assert (SHAPES * normal, SHAPES * sheared) == (11_900, 476_000)


def test_algorithm_2_has_the_states_of_its_grid() -> None:
    """14 x 25 points x 12 depths = 4,200, all normal, 1.2 mm deep in the end."""
    visits = list(pad_algorithm(top_mm=4.0))
    assert SHAPES * sum(len(visit.recorded) for visit in visits) == 4200
    assert {visit.press.depth_mm for visit in visits} == {1.2}
    assert {visit.press.target_mm for visit in visits} == {
        (x, y, 4.0) for x, y in itertools.product((-3.0, -1.5, 0.0, 1.5, 3.0), repeat=2)
    }


def test_steps_are_a_tenth_of_a_millimetre_along_the_normal_and_aside() -> None:
    """Depth 0.1 a frame, then 0.1 along U or V; diagonals end sqrt(0.5) = 0.707 mm aside."""
    skin = finger(grid_mm=2.0)[0].outer
    collider = make_collider(Indenter(), grid_mm=0.5)
    # The third depth at 50 degrees on the path of +X.
    visits = [v for v in finger_algorithm() if v.point == 5 and v.press.frames == 3]
    assert [visit.direction for visit in visits] == list(range(8))
    ends = []
    for visit in visits:
        approach = plan_approach(skin, collider, visit.press)
        origins, turned = approach.poses(np.arange(visit.press.frame_count + 1.0))
        steps = np.diff(origins, axis=0)
        np.testing.assert_allclose(steps[:3], -0.1 * np.tile(approach.normal, (3, 1)), atol=1e-12)
        aside = steps[3:] @ np.stack([approach.tangent_u, approach.tangent_v], axis=1)
        np.testing.assert_allclose(np.abs(aside).max(axis=1), 0.1, atol=1e-12)
        # Perpendicular to the surface: the body's Z is the outward normal, 50 degrees from +Z.
        exact = [np.sin(np.radians(50.0)), 0.0, np.cos(np.radians(50.0))]
        # Facets of 0.4 mm on R 15 turn by 0.027 rad; interpolation leaves a small part of it.
        np.testing.assert_allclose(turned[:, :, 2], np.tile(exact, (9, 1)), atol=3e-3)
        ends.append(aside.sum(axis=0))
    angles = np.degrees(np.arctan2(*np.transpose(ends)[::-1])) % 360.0
    np.testing.assert_allclose(angles % (360.0 - 1e-9), 45.0 * np.arange(8), atol=1e-8)
    np.testing.assert_allclose(np.linalg.norm(ends, axis=1), [0.5, 0.5 * 2**0.5] * 4, rtol=1e-12)


def test_smaller_finger_and_no_shear() -> None:
    """2 paths x (2 + 3) + 1 = 11 points, one press each; the apex lies at 8 + 6 = 14 mm."""
    visits = list(
        finger_algorithm(
            outer_radius_mm=6.0,
            cylinder_mm=8.0,
            paths=2,
            tip_deg=(0.0, 45.0, 90.0),
            base_mm=(0.0, 1.0, 2.0, 3.0),
            directions=0,
        )
    )
    assert len(visits) == 11
    assert visits[0].press.target_mm == (0.0, 0.0, 14.0)


def test_grids_that_do_not_fit_are_refused() -> None:
    """Base positions below the base; a step that does not divide the depth."""
    with pytest.raises(DesignError, match=r"12 mm below the seam .* is 8 mm long"):
        finger_points_mm(cylinder_mm=8.0)
    with pytest.raises(DesignError, match=r"1 mm is not a whole number of steps of 0\.3 mm"):
        list(finger_algorithm(step_mm=0.3))
