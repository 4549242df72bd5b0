"""Paths that mislead a solver that looks at them too rarely, or sets what it should move."""

import dataclasses

import numpy as np
import pytest

from sim.contact.motion.approach import plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.press import press_membrane
from sim.contact.readout.problem import make_problem
from sim.contact.region.refinement import path_distance_mm, path_samples
from sim.contact.solver.reactions import Reactions
from sim.contact.solver.solver import solve
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.design.design import Elastomer
from workbench.core.press.actuation import Actuation
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.motion import slide
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody
from workbench.core.press.trajectory import Trajectory

pytestmark = pytest.mark.usefixtures("taichi_device")

MESH, POINTS = flat_block(width_mm=12.0, height_mm=2.0, grid_mm=0.5, skin_mm=0.5)
PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.4, frames=2)
SETTINGS = ContactSettings(active_radius_mm=8.0)


def test_a_path_that_comes_and_goes_is_seen_at_its_far_end() -> None:
    """Fifty times 3 mm out and back: places under the far end are as near as those at home."""
    strokes = tuple(slide(sign * 3.0, 0.0, frames=1) for _ in range(50) for sign in (1.0, -1.0))
    press = dataclasses.replace(PRESS, strokes=strokes)
    collider = make_collider(Indenter(), grid_mm=0.5)
    approach = plan_approach(MESH.outer, collider, press)
    samples = path_samples(approach)
    assert set(range(approach.frame_count + 1)) <= set(samples.tolist())
    origins, _ = approach.poses(np.array([2.0, 3.0]))
    under = [[*origin[:2], 2.0] for origin in origins]
    home_mm, far_mm = path_distance_mm(np.array(under), approach)
    assert home_mm == pytest.approx(-0.4, abs=1e-3)
    assert far_mm == pytest.approx(-0.4, abs=1e-3)


def test_frames_of_a_straight_press_with_friction_end_alike() -> None:
    """At mu 0.5 in 1, 2 and 8 frames: force within .5 %, friction, which is a path, within 20 %."""
    rough = Elastomer(friction=0.5)
    once, coarse, fine = (
        press_membrane(
            MESH,
            POINTS,
            rough,
            PressCase(press=dataclasses.replace(PRESS, frames=n), settings=SETTINGS),
        )
        for n in (1, 2, 8)
    )
    # Both rest each 0.1 mm, at the end of a frame to tighter limits.
    assert once.normal_N[-1] == pytest.approx(coarse.normal_N[-1], rel=5e-3)
    # Gone in one piece, one frame read 1.5 % too little.
    assert coarse.normal_N[-1] == pytest.approx(fine.normal_N[-1], rel=5e-3)
    # Measured 7 %; moved in half as many substeps 21 %, and half as much again of friction.
    assert coarse.tangential_N[-1] == pytest.approx(fine.tangential_N[-1], rel=0.2)


def test_reactions_are_those_of_the_whole_depth() -> None:
    """A press of 0.4 mm that rubs rests three times on its way; what counts is its end, exactly."""
    case = PressCase(press=dataclasses.replace(PRESS, frames=1), settings=SETTINGS)
    problem = make_problem(MESH, POINTS, Elastomer(friction=0.5), case)
    reactions = Reactions([problem])
    reactions.run()
    (contact,) = solve([problem])
    assert not isinstance(contact, SolveError)
    np.testing.assert_allclose(reactions.reaction_N[0], contact.reaction_N[-1], rtol=1e-6)
    assert contact.normal_N[-1] > 0.1


def test_a_soft_object_settles_before_it_touches() -> None:
    """A trajectory whose first frame ends in the air: no force there, then some."""
    height = 2.0 + 3.0
    rows = [[0.0, 0.0, height + z, 1.0, 0.0, 0.0, 0.0] for z in (1.5, 0.6, -0.3)]
    path = Trajectory.from_arrays(np.arange(3.0), np.array(rows))
    ball = Indenter(size_mm=6.0, soft=SoftBody())
    press = dataclasses.replace(PRESS, trajectory=path)
    contact = press_membrane(
        MESH, POINTS, Elastomer(), PressCase(indenter=ball, press=press, settings=SETTINGS)
    )
    assert np.linalg.norm(contact.reaction_N[0]) == 0.0
    assert contact.normal_N[-1] > 0.01


def test_keys_of_a_drive_lie_on_whole_frames() -> None:
    """A key at 0.5 would be passed by: a frame goes straight from its start to its end."""
    with pytest.raises(DesignError, match="not whole"):
        Actuation(keys=((0.0, 0.0), (0.5, 1.0), (1.0, 0.0)))


def test_a_cube_that_is_pressed_sticks_and_then_slides_as_a_whole() -> None:
    """Straight in at mu .3 hardly any of the contact slides, dragged far all of it does.

    Of the points most lie on the friction cone in the press too, a micrometre from where they
    touched: that is no slip. Finite elements say 0, 0 and .01 of a like press on the finger.
    """
    cube = Indenter(kind=IndenterKind("cube"), size_mm=4.0)
    press = dataclasses.replace(PRESS, frames=3, strokes=(slide(1.5, 0.0, frames=5),))
    found = press_membrane(
        MESH, POINTS, Elastomer(), PressCase(indenter=cube, press=press, settings=SETTINGS)
    )
    assert found.sliding_share[:3].max() < 0.1
    # All the same, points of the press are at the cone.
    assert found.friction_ratio[:3] == pytest.approx(np.full(3, 0.3), rel=0.01)
    assert found.sliding_share[-1] == 1.0
    assert 0.2 < found.sliding_share[3:].min() < 0.9
    touched = found.contact_force_N[-2:].any(axis=2).all(axis=0)
    assert found.sliding[-1][touched].mean() > 0.8
    # Friction lifts the skin off the flat before it meets the trailing edge anew: what did not
    # touch at both ends of the frame has not slid in it.
    place_mm = MESH.outer.points_mm + found.displacement_mm[-1] - found.indenter_pose[-1, :3]
    assert ((place_mm @ found.tangent_u)[touched & ~found.sliding[-1]] < -1.5).all()


def test_the_share_that_slides_does_not_depend_on_frames() -> None:
    """A ball dragged by .4 mm in frames of .1 or .05 mm; one of 29 places is .034 of a contact."""
    shares = []
    for frames in (4, 8):
        press = dataclasses.replace(PRESS, strokes=(slide(0.4, 0.0, frames=frames),))
        case = PressCase(press=press, settings=SETTINGS)
        found = press_membrane(MESH, POINTS, Elastomer(), case)
        # Of finer frames two share the way of a coarse one.
        dragged = found.sliding_share[2:].reshape(4, -1).mean(axis=1)
        shares.append(dragged)
    # A place that begins to slide within a coarse frame counts for all of it: measured .12 where
    # most of them begin, and .03 over the whole way.
    np.testing.assert_allclose(shares[0], shares[1], atol=0.15)
    assert np.mean(shares[0]) == pytest.approx(np.mean(shares[1]), abs=0.05)
    assert shares[0][1] > 0.1


def test_kinetic_friction_is_what_is_left_once_all_slides() -> None:
    """mu .5 and mu_k .3: dragged far, the cone of .3 within the places that just touched."""

    def ratio(material: Elastomer) -> float:
        press = dataclasses.replace(PRESS, strokes=(slide(2.0, 0.0, frames=10),))
        found = press_membrane(MESH, POINTS, material, PressCase(press=press, settings=SETTINGS))
        return float((found.tangential_N / found.pressing_N)[-1])

    both = ratio(Elastomer(friction=0.5, kinetic_friction=0.3))
    assert ratio(Elastomer(friction=0.3)) == pytest.approx(0.3, rel=0.01)
    assert 0.3 < both < 0.34
    assert ratio(Elastomer(friction=0.5)) == pytest.approx(0.5, rel=0.02)
