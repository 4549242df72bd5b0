"""Soft objects: kernel against twin, action against reaction, and the rigid limit."""

import dataclasses

import numpy as np
import pytest

from sim.contact.engine import reference
from sim.contact.press import press_membrane
from sim.contact.readout.problem import Problem, make_problem
from sim.contact.soft.body import SoftObject, make_soft_object
from sim.contact.soft.meeting import meet
from sim.contact.soft.meeting_functions import MEMBRANE, OBJECT
from sim.contact.soft.reference import commit_history, contact_forces
from sim.contact.soft.solver import SoftRelaxation, _shape
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import DesignError
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody
from workbench.core.result.sensing import Contact

pytestmark = pytest.mark.usefixtures("taichi_device")

MESH, POINTS = flat_block(width_mm=8.0, height_mm=3.0, grid_mm=0.5, skin_mm=0.5)
SMOOTH = Elastomer(friction=0.0)
PRESS = Press(target_mm=(0.1, 0.2, 3.0), depth_mm=0.5, frames=1)


def press(soft: SoftBody | None, material: Elastomer = SMOOTH, path: Press = PRESS) -> Contact:
    ball = Indenter(size_mm=6.0, soft=soft)
    settings = ContactSettings(active_radius_mm=7.5)
    return press_membrane(
        MESH, POINTS, material, PressCase(indenter=ball, press=path, settings=settings)
    )


def made(material: Elastomer = SMOOTH) -> tuple[Problem, SoftObject]:
    ball = Indenter(size_mm=6.0, soft=SoftBody())
    problem = make_problem(MESH, POINTS, material, PressCase(indenter=ball, press=PRESS))
    return problem, make_soft_object(problem, ball)


def prepared(material: Elastomer = SMOOTH) -> tuple[SoftRelaxation, SoftObject]:
    problem, soft = made(material)
    return SoftRelaxation(problem, soft), soft


def test_forces_friction_and_commit_equal_the_twin() -> None:
    """A ball whose nodes have moved at random, then slid: forces, anchors and ways to 1e-4."""
    relaxation, soft = prepared(Elastomer(friction=0.3))
    problem, random = relaxation.problem, np.random.default_rng(3)
    membrane_mm = random.uniform(-0.02, 0.02, (len(problem.domain.masses), 3))
    wobble_mm = random.uniform(-0.02, 0.02, (len(soft.domain.masses), 3))
    points = problem.domain.points
    stiffness = np.where(points.bonded, 0.0, points.stiffness_N_mm)
    history = reference.ContactHistory.fresh(points.count)
    origin, rotation = problem.approach.pose(1.0)
    at = reference.point_places(problem.domain, membrane_mm)
    # The held part is not driven, so the object still is where it began: carry it there.
    for aside_mm in (0.0, 0.05):
        origin = origin + np.array([aside_mm, 0.0, 0.0])
        object_mm = wobble_mm + (origin - soft.origin_mm) @ soft.rotation
        relaxation.batch.write(
            relaxation.batch.nodes.displacement,
            3 * relaxation.batch.spans[MEMBRANE].first_node,
            membrane_mm,
        )
        relaxation.batch.write(
            relaxation.batch.nodes.displacement,
            3 * relaxation.batch.spans[OBJECT].first_node,
            object_mm,
        )
        relaxation.set_poses(0, np.concatenate([origin, rotation.ravel(), [1.0]])[None])
        relaxation.evaluate(np.ones(1, bool))
        meeting = meet(soft, problem.collider, object_mm, at, (origin, rotation))
        meeting.cell[points.bonded] = -1
        forces, nodal = contact_forces(soft, meeting, stiffness, history, friction=0.3)
    assert np.count_nonzero(history.states) > 10
    touching = ~points.bonded
    found = relaxation.point_forces(MEMBRANE)[touching]
    # Places are good to 1e-6 mm in single precision, of overlaps of about 0.1 mm.
    bound = 1e-4 * np.abs(forces).max()
    assert np.abs(found - forces[touching]).max() < bound
    elastic = reference.stress_forces(soft.domain, object_mm)
    fresh = reference.ContactHistory.fresh(soft.domain.points.count)
    held = reference.surface_forces(
        soft.domain,
        object_mm,
        fresh,
        reference.PosedObject(problem.collider, (origin, rotation), 0.0),
    )
    exact = elastic + nodal + reference.spread_to_nodes(soft.domain, held)
    assert np.abs(relaxation.node_forces(OBJECT) - exact).max() < 1e-4 * np.abs(exact).max()
    relaxation.commit(0)
    commit_history(meeting, history, friction=0.3)
    anchors, states = relaxation.contact_history(MEMBRANE)
    np.testing.assert_array_equal(states[touching], history.states[touching])
    slid = touching & (history.states >= reference.HELD)
    np.testing.assert_allclose(anchors[slid], history.anchors[slid], atol=1e-5)
    assert history.slips.max() > 0.01
    np.testing.assert_allclose(relaxation.slips_mm(MEMBRANE)[slid], history.slips[slid], atol=1e-5)


def test_action_equals_reaction() -> None:
    """What the membrane's points lose the object's nodes gain, to single precision."""
    relaxation, soft = prepared()
    origin, rotation = relaxation.problem.approach.pose(1.0)
    way = np.tile((origin - soft.origin_mm) @ soft.rotation, (len(soft.domain.masses), 1))
    rest = np.zeros((len(relaxation.problem.domain.masses), 3))
    relaxation.restart(0, np.concatenate([rest, way]))
    relaxation.set_poses(0, np.concatenate([origin, rotation.ravel(), [1.0]])[None])
    goal = np.tile(way[0], (soft.domain.points.count, 1))
    relaxation.drive(OBJECT, goal, goal)
    balance = relaxation.evaluate(np.ones(1, bool))
    # A rigid shift strains nothing and the held part is where it belongs: contact is all there is.
    on_object = soft.rotation @ relaxation.node_forces(OBJECT).sum(axis=0, dtype=np.float64)
    assert balance.reaction_N[0, 2] > 0.05
    np.testing.assert_allclose(on_object, balance.reaction_N[0], atol=1e-5)


def test_a_shifted_object_has_moved_by_its_shift_less_what_its_frame_has() -> None:
    """By 0.1, -0.2, 0.3 mm at every place; by nothing in a frame that went along.

    In one that turned by 90 degrees about z, (x, y) lies at (y, -x) after the shift.
    """
    _, soft = made()
    shift_mm = np.array([0.1, -0.2, 0.3])
    nodal_mm = np.tile(shift_mm, (len(soft.domain.masses), 1))
    still = _shape(soft, nodal_mm, (soft.origin_mm, soft.rotation))
    assert still.shape == (*soft.cell_map.shape, 3)
    np.testing.assert_allclose(still, np.broadcast_to(shift_mm, still.shape), atol=1e-12)
    along_mm = soft.origin_mm + soft.rotation @ shift_mm
    np.testing.assert_allclose(_shape(soft, nodal_mm, (along_mm, soft.rotation)), 0.0, atol=1e-12)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    turned = _shape(soft, nodal_mm, (soft.origin_mm, soft.rotation @ quarter))
    cell = np.argwhere(soft.cell_map >= 0)[0]
    x, y, _ = (cell + soft.first_cell) * soft.domain.grid_mm
    exact = [y - 0.2 - x, -x - 0.1 - y, 0.3]
    np.testing.assert_allclose(turned[tuple(cell)], exact, atol=1e-12)


def test_stiff_object_presses_as_a_rigid_one() -> None:
    """Sixty times as stiff as the skin: less force by what it gives way, between 0 and 5 %."""
    rigid, stiff = press(None), press(SoftBody(young_MPa=60 * SMOOTH.young_MPa))
    ratio = stiff.normal_N[-1] / rigid.normal_N[-1]
    assert 0.95 < ratio < 1.0


def test_object_as_soft_as_the_skin_halves_the_force() -> None:
    """Hertz: the contact modulus of two equal bodies is half; the thin bonded layer takes more."""
    rigid, soft = press(None), press(SoftBody())
    ratio = soft.normal_N[-1] / rigid.normal_N[-1]
    assert 0.35 < ratio < 0.55
    # The skin and the ball share the depth; the ball is deformed where it is pressed.
    assert 0.15 < -soft.displacement_mm[-1, :, 2].min() < 0.35
    assert 0.1 < np.abs(soft.object_mm).max() < 0.4
    assert soft.residual.max() < 1e-3


def test_friction_drags_a_soft_object() -> None:
    """Sheared by 1 mm at mu 0.2: every point slides at the cone, and the ball leans back."""
    path = dataclasses.replace(PRESS, shear_mm=(1.0, 0.0), frames=2)
    contact = press(SoftBody(), dataclasses.replace(SMOOTH, friction=0.2), path)
    assert contact.friction_ratio[-1] == pytest.approx(0.2, rel=0.01)
    assert contact.slip_mm[-1].max() > 0.2
    along = contact.reaction_N[-1] @ contact.tangent_u
    assert along < -0.1 * contact.normal_N[-1]


def test_object_a_thousand_times_as_stiff_is_refused() -> None:
    """Two such bodies do not relax together: the remedy is a rigid object."""
    with pytest.raises(DesignError, match="1000 times as stiff") as raised:
        press(SoftBody(young_MPa=145.0))
    assert "rigid" in raised.value.hint


def test_a_soft_object_reads_one_force_in_any_number_of_frames() -> None:
    """At mu .3 in 1 and 5 frames: within .5 %; gone in one piece, 1 frame read .9 % too much."""
    rough = dataclasses.replace(SMOOTH, friction=0.3)
    once, often = (
        press(SoftBody(), rough, dataclasses.replace(PRESS, frames=frames)) for frames in (1, 5)
    )
    assert once.normal_N[-1] == pytest.approx(often.normal_N[-1], rel=5e-3)
    # Measured 5 %; left on its way after 300 substeps, settled or not, 13 %.
    assert once.tangential_N[-1] == pytest.approx(often.tangential_N[-1], rel=0.1)
