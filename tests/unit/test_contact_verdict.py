"""Verdicts on settled frames, and what the numbers of a frame are relative to."""

import dataclasses
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim.contact.engine.batch import Case
from sim.contact.engine.relaxation import Relaxation
from sim.contact.motion.approach import Approach, plan_approach
from sim.contact.objects.collider import make_collider
from sim.contact.readout.fields import volume_state
from sim.contact.readout.frame import FrameOutcome
from sim.contact.readout.outcome import SettledFrame, _drives, _friction_ratio, frame_outcome
from sim.contact.readout.problem import Problem, prepare
from sim.contact.readout.verdict import check_depth, check_frame
from sim.contact.region.quadrature import facets_of
from sim.contact.region.refinement import refine
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import DesignError, SolveError
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.press import ContactSettings, Press

pytestmark = pytest.mark.usefixtures("taichi_device")

MESH, POINTS = flat_block(width_mm=6.0, height_mm=2.0, grid_mm=0.5, skin_mm=0.4)
PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.4, frames=1)


def plan(press: Press = PRESS, indenter: Indenter | None = None) -> Approach:
    collider = make_collider(indenter or Indenter(size_mm=4.0), grid_mm=0.5)
    return plan_approach(MESH.outer, collider, press)


def frame(load_N: float = 1.0) -> tuple[FrameOutcome, Problem]:
    """A frame of the undeformed block under the ball; nothing has settled."""
    approach, material = plan(), Elastomer()
    domain = prepare(MESH, POINTS, material, approach, ContactSettings(), radius_mm=3.0)
    problem = Problem(
        mesh=MESH,
        material=material,
        settings=ContactSettings(),
        approach=approach,
        domain=domain,
        radius_mm=3.0,
    )
    relaxation = Relaxation([Case(domain=domain, collider=approach.collider, friction=0.3)])
    origin, rotation = approach.pose(1.0)
    relaxation.set_poses(0, np.concatenate([origin, rotation.ravel(), [1.0]])[None])
    balance = relaxation.evaluate(np.ones(1, bool)).of(0)
    settled = SettledFrame(
        number=0,
        balance=balance,
        load_N=load_N,
        seconds=0.0,
        nodal_mm=relaxation.displacement(),
        point_forces_N=relaxation.point_forces(),
        cut_N=np.zeros(3),
    )
    return frame_outcome(problem, settled), problem


def test_overlap_is_looked_for_on_the_whole_skin() -> None:
    """The ball lies 0.4 mm in the undeformed skin, more than half a cell of 0.5 mm."""
    outcome, problem = frame()
    approach = problem.approach
    # The nearest vertex is 0.2 sqrt(2) mm off the axis and 1.6 mm below the centre.
    assert outcome.penetration_mm == pytest.approx(2.0 - np.hypot(0.2 * 2**0.5, 1.6), abs=1e-4)
    with pytest.raises(SolveError, match=r"overlap by 0\.375 mm; the limit is 0\.250 mm") as raised:
        check_frame(outcome, approach, 0, grid_mm=0.5)
    assert "penalty" in raised.value.hint
    nan = dataclasses.replace(outcome, penetration_mm=float("nan"))
    with pytest.raises(SolveError, match="overlap"):
        check_frame(nan, approach, 0, grid_mm=0.5)


def test_depth_without_force_is_an_error_but_release_is_not() -> None:
    """No reaction at 0.4 mm of depth is refused; at a depth of 0.001 mm it is not."""
    outcome, problem = frame()
    approach = problem.approach
    empty = dataclasses.replace(outcome, reaction_N=np.zeros(3), penetration_mm=0.0)
    with pytest.raises(SolveError, match="passed between contact points"):
        check_frame(empty, approach, 0, grid_mm=0.5)
    shallow = dataclasses.replace(approach.press, depth_mm=1e-3)
    check_frame(empty, dataclasses.replace(approach, press=shallow), 0, grid_mm=0.5)
    sliding = dataclasses.replace(approach.press, shear_mm=(9.0, 0.0))
    check_frame(empty, dataclasses.replace(approach, press=sliding), 1, grid_mm=0.5)


def test_crushed_elastomer_is_an_error() -> None:
    """J of u = H x is det(I + H): 1.1 x 0.9 x 0.8, then 0.01 by squeezing along z."""
    outcome, problem = frame()
    domain = problem.domain
    spread = domain.node_mm * [0.1, -0.1, -0.2]
    # Single precision has 6e-8 and the nodes lie 6 cells out.
    assert volume_state(domain, spread).least_volume_ratio == pytest.approx(0.792, abs=1e-5)
    flat = volume_state(domain, domain.node_mm * [0.0, 0.0, -0.99]).least_volume_ratio
    fine = dataclasses.replace(outcome, penetration_mm=0.0, least_volume_ratio=flat)
    with pytest.raises(SolveError, match=r"crushed to 0\.010 .* limit is 0\.02"):
        check_frame(fine, problem.approach, 0, grid_mm=0.5)


def test_residual_has_the_scale_of_the_stop_test() -> None:
    """Out-of-balance force over the given scale, whatever the reaction."""
    coarse, fine = frame(load_N=2.0)[0], frame(load_N=0.5)[0]
    assert coarse.residual > 0.0
    assert fine.residual == pytest.approx(4.0 * coarse.residual, rel=1e-12)


def test_friction_ratio_comes_from_forces_alone() -> None:
    """Forces 0.5 and 0.1 aside per 1 along the normal, and a faint one: 0.5 is the largest."""
    aside, pressing = np.array([0.5, 0.1, 1e-6, 0.0]), np.array([1.0, 1.0, 1e-7, 0.0])
    assert _friction_ratio(pressing, aside) == pytest.approx(0.5)


def test_drives_pull_at_their_own_points_and_turn_about_their_own_axes() -> None:
    """2 N along z at 3 mm along x turn by -6 N mm about y; two of 1 N at 0 and 4 mm turn about
    their middle by nothing; one that no point follows does nothing."""
    problem: Any = SimpleNamespace(
        press=SimpleNamespace(
            actuations=[
                SimpleNamespace(about_mm=about_mm)
                for about_mm in ((1.0, 0.0, 0.0), (0.0, 2.0, 5.0), (0.0, 0.0, 0.0))
            ]
        ),
        domain=SimpleNamespace(points=SimpleNamespace(drive=np.array([0, -1, 1, 1]))),
    )
    forces = np.array([[0.0, 0.0, 2.0], [9.0, 9.0, 9.0], [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]])
    places = np.array([[4.0, 0.0, 0.0], [7.0, 7.0, 7.0], [0.0, 0.0, 5.0], [0.0, 4.0, 5.0]])
    forces_N, moments_Nmm = _drives(problem, forces, places)
    np.testing.assert_array_equal(forces_N, [[0.0, 0.0, 2.0], [2.0, 0.0, 0.0], [0.0, 0.0, 0.0]])
    np.testing.assert_array_equal(moments_Nmm, [[0.0, -6.0, 0.0], [0.0] * 3, [0.0] * 3])


def test_depth_that_reaches_the_support_is_refused() -> None:
    """A wall of 2 mm takes at most 2.0 mm; a shear alone does not change that of a flat block."""
    approach = plan(dataclasses.replace(PRESS, depth_mm=2.5, shear_mm=(0.5, 0.0)))
    with pytest.raises(DesignError, match=r"2\.5 mm .* that fits is 2\.0 mm") as raised:
        check_depth(MESH.inner.points_mm, approach)
    assert raised.value.at == "press.depth_mm"
    check_depth(MESH.inner.points_mm, plan(dataclasses.replace(PRESS, depth_mm=1.9)))


def test_depth_that_passes_right_through_is_refused() -> None:
    """A ball of 4 mm ends 48 mm below the support of a 2 mm wall: it met it at 2.0 mm."""
    with pytest.raises(DesignError, match=r"50 mm .* that fits is 2\.0 mm"):
        check_depth(MESH.inner.points_mm, plan(dataclasses.replace(PRESS, depth_mm=50.0)))


@pytest.mark.parametrize(
    ("indenter", "depth_mm", "longest_mm"),
    [
        (Indenter(kind=IndenterKind.CONE), 0.1, 0.225),
        (Indenter(size_mm=1.0), 0.05, 0.25),
        (Indenter(), 1.0, 0.6),
    ],
)
def test_edges_under_the_indenter_are_short(
    indenter: Indenter, depth_mm: float, longest_mm: float
) -> None:
    """At most half the least radius and 1.2 cells; a 6 mm ball leaves the skin as it is."""
    approach = plan(dataclasses.replace(PRESS, depth_mm=depth_mm), indenter)
    before = facets_of(MESH.outer, np.arange(len(MESH.outer.faces)), spacing_mm=0.6)
    after = refine(before, approach, grid_mm=0.5)
    centre = after.corners_mm().mean(axis=1)
    under = np.linalg.norm(centre - approach.target_mm, axis=1) < 0.3
    assert after.longest_edges_mm()[under].max() <= longest_mm
    assert (len(after.triangles) == len(before.triangles)) == (longest_mm == 0.6)
    assert area_mm2(after) == pytest.approx(36.0, rel=1e-12)


def area_mm2(facets) -> float:
    a, b, c = np.moveaxis(facets.corners_mm(), 1, 0)
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2)


def test_shallow_first_frame_has_points_to_touch() -> None:
    """A 6 mm ball 2 um deep covers a spot of 0.11 mm, between vertices 0.4 mm apart."""
    press = dataclasses.replace(PRESS, target_mm=(0.2, 0.1, 2.0), depth_mm=0.002)
    approach = plan(press, Indenter())
    facets = facets_of(MESH.outer, np.arange(len(MESH.outer.faces)), spacing_mm=0.6)
    facets = refine(facets, approach, grid_mm=0.5)
    origin, rotation = approach.pose(1.0)
    distance, _ = approach.collider.distance((facets.points_mm - origin) @ rotation)
    assert np.count_nonzero(distance < 0.0) >= 4
