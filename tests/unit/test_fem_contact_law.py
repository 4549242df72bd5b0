"""Contact and friction at points: derivatives, the cone, memory; the curvature of every object."""

from __future__ import annotations

import numpy as np
import pytest

from sim.contact.objects.collider import make_collider
from sim.fem.contact_law import SLIP_MM, SOFT_MM, Law, Touch, Traction, traction
from sim.fem.obstacle import RigidPose, curvature, distance
from sim.fem.studies.tangents import GRID_MM, POSE, rub, tangent_errors
from workbench.core.press.indenter import Indenter, IndenterKind

KINDS = [kind for kind in IndenterKind if kind is not IndenterKind.MESH]
LAW = Law(penalty_MPa_mm=200.0, friction=0.3)
UP = np.array([[0.0, 0.0, 1.0]])


def on_plane(depth_mm: float, slip_mm: tuple[float, float], *, law: Law = LAW) -> Traction:
    """One point below a plane object whose distance grows along +Z."""
    touch = Touch(
        distance_mm=np.array([-depth_mm]),
        gradient=UP,
        curvature=np.zeros((1, 3, 3)),
        slip_mm=np.array([[*slip_mm, 0.0]]),
    )
    return traction(law, touch)


@pytest.mark.parametrize(
    "kind", [IndenterKind.SPHERE, IndenterKind.CUBE, IndenterKind.CONE, IndenterKind.TORUS]
)
def test_tangents_are_derivatives(kind: IndenterKind) -> None:
    """Normal, friction, friction held, and the potential: to 1e-6 at the worst of all points."""
    errors = tangent_errors(Indenter(kind=kind))
    assert errors.points > 300
    assert max(errors.contact, errors.friction, errors.held, errors.energy) < 1e-6
    assert errors.uncurved > 1e-3
    assert errors.cone == pytest.approx(1.0, abs=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("kind", KINDS)
def test_tangents_of_every_object(kind: IndenterKind) -> None:
    errors = tangent_errors(Indenter(kind=kind))
    assert max(errors.contact, errors.friction, errors.held, errors.energy) < 1e-6


@pytest.mark.parametrize("kind", KINDS)
def test_curvature_is_the_slope_of_the_gradient(kind: IndenterKind) -> None:
    """grad phi by central differences at points in contact, none at a jump of the curvature."""
    rubbed, h = rub(Indenter(kind=kind), friction=0.0), 1e-6
    places_mm = rubbed.places_mm[:400]
    columns = [
        distance(rubbed.collider, POSE, places_mm + step)[1]
        - distance(rubbed.collider, POSE, places_mm - step)[1]
        for step in h * np.eye(3)
    ]
    measured = np.stack(columns, axis=2) / (2.0 * h)
    known = curvature(rubbed.collider, POSE, places_mm)
    assert np.abs(known).max() > 0.1
    assert np.abs(known - known.transpose(0, 2, 1)).max() < 1e-12
    # A jump between the two steps, 1e-6 here against 1e-7 there, is met by fewer than 1 %.
    assert np.quantile(np.abs(measured - known).max(axis=(1, 2)), 0.99) < 1e-6


def test_curvature_of_a_sphere_is_exact() -> None:
    """H = (I - n n^T) / r."""
    collider = make_collider(Indenter(size_mm=6.0), grid_mm=GRID_MM)
    still = RigidPose(origin_mm=np.zeros(3), rotation=np.eye(3))
    found = curvature(collider, still, np.array([[0.0, 0.0, -2.9]]))
    np.testing.assert_allclose(found[0], np.diag([1.0, 1.0, 0.0]) / 2.9, atol=1e-14)


def test_far_points_of_a_sampled_object_have_a_bound_and_near_ones_the_distance() -> None:
    """In front of the samples' box nothing touches, and the bound is below the true distance."""
    collider = make_collider(Indenter(kind=IndenterKind.TORUS, size_mm=6.0), grid_mm=GRID_MM)
    points_mm = POSE.origin_mm + np.random.default_rng(0).uniform(-6.0, 6.0, (4000, 3))
    found, slopes = distance(collider, POSE, points_mm)
    known, gradient = collider.distance((points_mm - POSE.origin_mm) @ POSE.rotation)
    near = slopes.any(axis=1)
    assert 200 < near.sum() < 2000 and (known[near] < 0.0).any()
    np.testing.assert_array_equal(found[near], known[near])
    np.testing.assert_array_equal(slopes[near], gradient[near] @ POSE.rotation.T)
    assert (found[~near] > 0.0).all() and (found[~near] <= known[~near] + 1e-12).all()


def test_an_object_carries_points_with_it() -> None:
    """A point fixed to the object keeps its body coordinates."""
    after = RigidPose(origin_mm=np.array([0.3, 0.0, 1.0]), rotation=POSE.rotation.T)
    place_mm = np.array([[0.4, 0.5, 0.6]])
    moved_mm = after.carried(place_mm, POSE)
    np.testing.assert_allclose(
        (moved_mm - after.origin_mm) @ after.rotation,
        (place_mm - POSE.origin_mm) @ POSE.rotation,
        atol=1e-15,
    )


def test_pressure_is_continuous_where_the_penalty_sets_in() -> None:
    """eps p^2 / (2 delta) meets eps (p - delta / 2) at delta with the same value and slope."""
    below, above = (on_plane(SOFT_MM * (1 + s * 1e-9), (0.0, 0.0)) for s in (-1, 1))
    np.testing.assert_allclose(below.normal_MPa, above.normal_MPa, rtol=1e-8)
    assert below.stiffness_MPa_mm is not None
    assert above.stiffness_MPa_mm is not None
    np.testing.assert_allclose(below.stiffness_MPa_mm, above.stiffness_MPa_mm, rtol=1e-8)
    np.testing.assert_allclose(below.energy_N_mm, above.energy_N_mm, rtol=1e-8)
    np.testing.assert_allclose(above.normal_MPa, [[0.0, 0.0, 0.5 * 200.0 * SOFT_MM]], rtol=1e-8)


def test_no_contact_no_traction() -> None:
    apart = on_plane(-1e-3, (1e-3, 0.0))
    assert not apart.total_MPa.any()
    assert apart.stiffness_MPa_mm is not None
    assert not apart.stiffness_MPa_mm.any()


def test_friction_opposes_slip_and_stays_in_the_cone() -> None:
    """(2 y - y^2) of the cone before sliding, all of it beyond, whatever the slip."""
    for slip in (0.1, 0.5, 1.0, 7.0, 1e6):
        pull = on_plane(0.01, (slip * SLIP_MM, 0.0))
        share = min(1.0, slip * (2.0 - slip)) if slip < 1.0 else 1.0
        pressure_MPa = pull.normal_MPa[0, 2]
        np.testing.assert_allclose(
            pull.friction_MPa, [[-0.3 * share * pressure_MPa, 0.0, 0.0]], rtol=1e-12
        )


def test_slip_along_the_normal_rubs_nothing() -> None:
    touch = Touch(
        distance_mm=np.array([-0.01]), gradient=UP, curvature=None, slip_mm=np.array([[0, 0, 0.2]])
    )
    assert not traction(LAW, touch).friction_MPa.any()


def test_a_point_remembers_stick_slide_and_reversal() -> None:
    """Slid 4 gamma it keeps gamma; back by 2 gamma it pulls as hard the other way."""
    slid = on_plane(0.01, (4.0 * SLIP_MM, 0.0))
    np.testing.assert_allclose(slid.elastic_mm, [[SLIP_MM, 0.0, 0.0]], rtol=1e-12)
    np.testing.assert_allclose(slid.slid_mm, [3.0 * SLIP_MM], rtol=1e-12)
    stuck = on_plane(0.01, (0.4 * SLIP_MM, 0.0))
    np.testing.assert_allclose(stuck.elastic_mm, [[0.4 * SLIP_MM, 0.0, 0.0]], rtol=1e-12)
    assert stuck.slid_mm[0] == 0.0
    kept_mm = slid.elastic_mm[0, 0]
    back = on_plane(0.01, (kept_mm - 2.0 * SLIP_MM, 0.0))
    np.testing.assert_allclose(back.friction_MPa, -slid.friction_MPa, rtol=1e-12)
    released = on_plane(0.01, (kept_mm - SLIP_MM, 0.0))
    assert np.abs(released.friction_MPa).max() < 1e-15


def test_without_friction_the_tangent_is_symmetric() -> None:
    """A potential has a symmetric tangent; that of friction is not."""
    smooth = rub(Indenter(kind=IndenterKind.CONE), friction=0.0).at(0.0, tangent=True)
    rough = rub(Indenter(kind=IndenterKind.CONE)).at(0.0, tangent=True)
    skew = [
        np.abs(k - k.transpose(0, 2, 1)).max()
        for k in (smooth.stiffness_MPa_mm, rough.stiffness_MPa_mm)
        if k is not None
    ]
    assert skew[0] < 1e-12
    assert skew[1] > 1.0


def test_convex_stiffness_has_no_negative_part() -> None:
    """Without the object's curvature every stiffness with held friction is at least zero."""
    rubbed = rub(Indenter(kind=IndenterKind.SPHERE))
    lag = rubbed.at(0.0).lag
    places_mm = rubbed.places_mm
    away_mm, gradient = distance(rubbed.collider, POSE, places_mm)
    touch = Touch(
        distance_mm=away_mm,
        gradient=gradient,
        curvature=curvature(rubbed.collider, POSE, places_mm),
        slip_mm=rubbed.slip_mm,
    )
    least = []
    for convex in (True, False):
        stiffness = traction(rubbed.law, touch, lag=lag, convex=convex).stiffness_MPa_mm
        assert stiffness is not None
        least.append(float(np.linalg.eigvalsh(stiffness).min()))
    assert least[0] > -1e-9
    assert least[1] < -1e-3


def test_what_slid_is_held_by_kinetic_friction() -> None:
    """At 40 um of slip both points are at their cones: mu_k p where it slid before, else mu p."""
    law = Law(penalty_MPa_mm=200.0, friction=0.3, kinetic_friction=0.1)
    touch = Touch(
        distance_mm=np.full(2, -0.01),
        gradient=np.repeat(UP, 2, axis=0),
        curvature=np.zeros((2, 3, 3)),
        slip_mm=np.tile([0.04, 0.0, 0.0], (2, 1)),
        slides=np.array([False, True]),
    )
    found = traction(law, touch)
    ratio = np.linalg.norm(found.friction_MPa, axis=1) / np.linalg.norm(found.normal_MPa, axis=1)
    assert ratio == pytest.approx([0.3, 0.1], rel=1e-12)
