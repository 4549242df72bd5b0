"""A press of a small pad: balance, frames, memory of friction, and what is refused."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
import pytest

from sim.contact.motion.path import turn
from sim.contact.objects.collider import make_collider
from sim.fem.contact_law import Law as ContactLaw
from sim.fem.elements import displacement_gradient, evaluate, make_elements
from sim.fem.increment import Pairing, _load, at_rest
from sim.fem.obstacle import RigidPose
from sim.fem.press import set_up, solve_press
from sim.fem.readout import FemFrame, _point_stress
from sim.fem.studies.blocks import flat_membrane, irregular_block
from sim.fem.tangent import Tangent
from workbench.core.base.errors import Cancelled, DesignError, MeshingError, SolveError
from workbench.core.design.design import Elastomer, Law
from workbench.core.press.fem import FemSettings
from workbench.core.press.indenter import Indenter, IndenterKind
from workbench.core.press.motion import release, slide
from workbench.core.press.press import Press
from workbench.core.press.press_case import PressCase
from workbench.core.press.soft_body import SoftBody
from workbench.core.result.force_field import ForceField, Source

SETTINGS = FemSettings(hex_mm=0.9, radius_mm=4.0)
PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.3, frames=3)
SHEARED = dataclasses.replace(PRESS, shear_mm=(0.2, 0.0), strokes=(release(frames=2),))


@functools.cache
def pressed(
    press: Press = PRESS,
    settings: FemSettings = SETTINGS,
    indenter: Indenter = Indenter(),  # noqa: B008
    gap_mm: float = 0.0,
    young_MPa: float = 0.145,
) -> ForceField:
    mesh = flat_membrane(width_mm=10.0, gap_mm=gap_mm)
    return solve_press(
        mesh,
        Elastomer(young_MPa=young_MPa),
        PressCase(indenter=indenter, press=press, fem=settings),
    )


def test_frames_are_stacked_and_named() -> None:
    """Every array has a row per frame and a column per vertex; all are finite."""
    found, mesh = pressed(), flat_membrane(width_mm=10.0)
    assert found.source is Source.FEM
    vertices = len(mesh.outer.points_mm)
    assert found.displacement_mm.shape == (3, vertices, 3)
    assert found.inner_mm.shape == (3, len(mesh.inner.points_mm), 3)
    assert found.cauchy_MPa.shape == (3, vertices, 6)
    assert found.indenter_pose.shape == (3, 7)
    assert found.radius_mm == 4.0
    assert "hexahedra" in found.solver
    for field in dataclasses.fields(found):
        value = getattr(found, field.name)
        if isinstance(value, np.ndarray) and value.dtype.kind == "f":
            assert np.isfinite(value).all(), field.name


def test_forces_balance() -> None:
    """Reaction = minus the sum of contact forces = support + cut; residual within tolerance."""
    found = pressed()
    assert found.converged.all()
    assert (found.residual <= SETTINGS.tolerance).all()
    # Contact forces are stored in single precision.
    summed_N = found.contact_force_N.astype(np.float64).sum(axis=1)
    np.testing.assert_allclose(found.reaction_N, -summed_N, atol=1e-6)
    np.testing.assert_allclose(
        found.reaction_N, found.support_N + found.cut_N, atol=1e-4 * found.normal_N[-1]
    )
    assert (found.balance < 1e-4).all()
    assert found.normal_N[0] > 0.0
    assert (np.diff(found.normal_N) > 0.0).all()


def test_a_centred_press_is_symmetric() -> None:
    """Nothing sideways and no moment under the middle of a square pad."""
    found = pressed()
    assert np.abs(found.tangential_N).max() < 1e-4 * found.normal_N[-1]
    assert np.abs(found.moment_Nmm).max() < 1e-3 * found.normal_N[-1]


def test_force_is_proportional_to_stiffness() -> None:
    """Statics is linear in E, the penalty included: to the tolerance of the residual."""
    doubled = pressed(young_MPa=0.29)
    np.testing.assert_allclose(doubled.reaction_N, 2.0 * pressed().reaction_N, atol=1e-5)


def test_shear_drags_the_skin_and_friction_stays_in_the_cone() -> None:
    """Sheared along U, the object is held back along -U; no point pulls by more than mu p.

    The whole force may: the skin in front of a ball is tilted against it.
    """
    found = pressed(SHEARED)
    sideways_N = found.reaction_N @ found.tangent_u
    end = 2 * PRESS.frames - 1
    assert sideways_N[end] < -0.05 * found.normal_N[end]
    assert found.friction_ratio.max() <= 0.3 * (1 + 1e-12)
    assert found.sliding[end].any()
    assert found.slip_mm[end].max() > 0.0
    assert (found.displacement_mm[end] @ found.tangent_u).max() > 0.05


def test_after_a_release_everything_is_back() -> None:
    """No force and no displacement are left: the solid is elastic, and friction forgets."""
    found = pressed(SHEARED)
    assert np.abs(found.reaction_N[-1]).max() == 0.0
    # The residual counts as converged below 1e-10 N, over 0.1 N/mm of stiffness.
    assert np.abs(found.displacement_mm[-1]).max() < 1e-6
    assert not found.slip_mm[-1].any()
    assert not found.pressure_MPa[-1].any()
    # What rounding leaves is not out of balance.
    assert (found.balance < 1e-4).all()


def test_a_twist_is_resisted() -> None:
    """A right-handed twist about the normal meets a moment the other way, and no net force."""
    twisted = dataclasses.replace(PRESS, twist_deg=10.0)
    found = pressed(twisted, indenter=Indenter(kind=IndenterKind.CYLINDER_END, size_mm=4.0))
    moment_Nmm, force_N = found.moment_Nmm[-1] @ found.normal, found.normal_N[-1]
    # All of a flat end sliding resists by mu F times two thirds of its radius; an edge by more.
    assert -0.3 * force_N * 2.0 < moment_Nmm < -0.1 * force_N
    assert found.tangential_N[-1] < 1e-3 * force_N
    # The skin turns the same way: at +x it goes toward +y.
    moved_mm = found.displacement_mm[-1]
    place_mm = flat_membrane(width_mm=10.0).outer.points_mm - found.target_mm
    assert (np.cross(place_mm, moved_mm) @ found.normal).max() > 0.05


def test_friction_remembers_across_increments() -> None:
    """A shear of 4 micrometres, less than the elastic slip, is the same in one step or in four."""
    at_once, by_and_by = (
        pressed(dataclasses.replace(PRESS, strokes=(slide(0.004, 0.0, frames=frames),)))
        for frames in (1, 4)
    )
    sheared_N = at_once.tangential_N[-1]
    assert sheared_N > 0.002 * at_once.normal_N[-1]
    assert by_and_by.tangential_N[-1] == pytest.approx(sheared_N, rel=0.02)


def test_what_friction_remembers_turns_with_the_object() -> None:
    """Elastic slip turns as a line on the object does."""
    poses = [
        RigidPose(origin_mm=np.array([0.0, 0.0, 5.0]), rotation=np.eye(3)),
        RigidPose(
            origin_mm=np.array([1.0, 0.0, 5.0]), rotation=turn(np.array([0.0, 0.0, 1.0]), 0.5)
        ),
    ]
    _, submodel = set_up(flat_membrane(), Elastomer(), PressCase(press=PRESS, fem=SETTINGS))
    pairing = Pairing(
        tangent=Tangent(submodel.body),
        law=ContactLaw(penalty_MPa_mm=200.0, friction=0.3),
        collider=make_collider(Indenter(), grid_mm=0.25),
        pose_at=lambda progress: poses[round(progress)],
        held_mm=lambda progress: np.zeros(3),
        tolerance=1e-6,
    )
    state = at_rest(pairing)
    line_mm = state.places_mm[1] - state.places_mm[0]
    elastic_mm = np.tile(line_mm, (len(state.places_mm), 1))
    load = _load(pairing, dataclasses.replace(state, elastic_mm=elastic_mm), 1.0)
    np.testing.assert_allclose(
        load.elastic_mm[0], load.anchor_mm[1] - load.anchor_mm[0], atol=1e-14
    )
    assert np.linalg.norm(load.elastic_mm[0] - line_mm) > 0.1 * np.linalg.norm(line_mm)


def test_linear_solver_makes_no_difference(monkeypatch: pytest.MonkeyPatch) -> None:
    """SuperLU, which counts no pivots, finds the same state."""
    monkeypatch.setattr("sim.fem.linear_solver.has_pardiso", lambda: False)
    found = solve_press(
        flat_membrane(width_mm=10.0), Elastomer(), PressCase(press=PRESS, fem=SETTINGS)
    )
    assert found.solver.endswith("SuperLU")
    np.testing.assert_allclose(found.reaction_N, pressed().reaction_N, atol=1e-6)


def test_gel_carries_a_skin_above_a_gap() -> None:
    """On gel the skin sinks and pushes less than bonded; the gel's force is in the balance."""
    soft, hard = pressed(gap_mm=2.0), pressed()
    assert 0.0 < soft.normal_N[-1] < 0.8 * hard.normal_N[-1]
    assert soft.inner_mm[-1, :, 2].min() < -0.05
    assert (soft.balance < 1e-4).all()


def test_a_long_frame_is_divided_into_increments() -> None:
    """0.1 mm of way at most: three increments for 0.3 mm, and the same answer as three frames."""
    once = pressed(dataclasses.replace(PRESS, frames=1))
    assert once.increments.tolist() == [3]
    assert pressed().increments.tolist() == [1, 1, 1]
    np.testing.assert_allclose(once.reaction_N[-1], pressed().reaction_N[-1], atol=1e-8)


def test_every_frame_is_told_as_soon_as_it_has_converged() -> None:
    told: list[tuple[int, FemFrame]] = []
    found = solve_press(
        flat_membrane(width_mm=10.0),
        Elastomer(),
        PressCase(press=PRESS, fem=SETTINGS),
        on_frame=lambda number, frame: told.append((number, frame)),
    )
    assert [number for number, _ in told] == [0, 1, 2]
    np.testing.assert_array_equal(
        np.stack([frame.reaction_N for _, frame in told]), found.reaction_N
    )


def test_the_monitor_stops_a_press() -> None:
    """It is asked within the first frame too, and its error comes through unchanged."""
    asked: list[float] = []

    def monitor(fraction: float, note: str = "") -> None:
        asked.append(fraction)
        if len(asked) > 3:
            raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        solve_press(
            flat_membrane(), Elastomer(), PressCase(press=PRESS, fem=SETTINGS), monitor=monitor
        )
    assert max(asked) < 1.0 / 3.0


def test_a_soft_object_is_refused() -> None:
    with pytest.raises(DesignError, match="rigid objects only") as caught:
        pressed(indenter=Indenter(soft=SoftBody()))
    assert caught.value.at == "indenter.soft"


def test_a_membrane_without_hexahedra_is_refused() -> None:
    mesh = dataclasses.replace(flat_membrane(), hexes=None, notice="an imported body")
    with pytest.raises(MeshingError, match="an imported body"):
        solve_press(mesh, Elastomer(), PressCase(press=PRESS, fem=SETTINGS))


def test_a_press_into_the_support_is_refused() -> None:
    with pytest.raises(DesignError, match="reaches the support"):
        pressed(dataclasses.replace(PRESS, depth_mm=2.5))


def fails_after(frame: int, monkeypatch: pytest.MonkeyPatch) -> SolveError:
    """Solve with increments that do not converge once the path has passed a frame."""
    import sim.fem.increment as increment

    solved = increment.increment

    def refused(pairing, state, progress, effort):  # type: ignore[no-untyped-def]
        if progress > frame:
            pairing = dataclasses.replace(pairing, tolerance=0.0)
        return solved(pairing, state, progress, effort)

    monkeypatch.setattr(increment, "increment", refused)
    monkeypatch.setattr(increment, "MOST_HALVINGS", 0)
    with pytest.raises(SolveError) as caught:
        solve_press(flat_membrane(), Elastomer(), PressCase(press=PRESS, fem=SETTINGS))
    return caught.value


def test_what_does_not_converge_is_never_an_answer(monkeypatch: pytest.MonkeyPatch) -> None:
    """No residual is below zero: the third frame fails, and the first two come with the error."""
    error = fails_after(2, monkeypatch)
    assert "frame 3 of 3" in error.message
    assert "did not converge" in error.message
    assert error.hint
    assert (error.frame, error.last_good) == (2, 1)
    assert isinstance(error.partial, ForceField)
    assert error.partial.converged.tolist() == [True, True]
    np.testing.assert_allclose(error.partial.residual < SETTINGS.tolerance, True)


def test_no_frame_no_partial_result(monkeypatch: pytest.MonkeyPatch) -> None:
    error = fails_after(0, monkeypatch)
    assert (error.frame, error.last_good, error.partial) == (0, -1, None)


def test_the_pole_of_a_region_grows_with_the_shear() -> None:
    """What takes part reaches 4 mm beyond where the object ends."""
    _, submodel = set_up(
        flat_membrane(width_mm=10.0), Elastomer(), PressCase(press=SHEARED, fem=SETTINGS)
    )
    assert submodel.part.radius_mm == pytest.approx(4.2)
    whole = dataclasses.replace(SETTINGS, radius_mm=0.0)
    _, submodel = set_up(flat_membrane(), Elastomer(), PressCase(press=PRESS, fem=whole))
    assert submodel.part.radius_mm == np.inf


@pytest.mark.parametrize("law", Law)
def test_energy_density_sums_to_the_strain_energy(law: Law) -> None:
    """What is shown per volume is what the forces are the slope of."""
    points_mm, cells = irregular_block()
    elements = make_elements(
        points_mm, cells, shear_MPa=0.05, bulk_MPa=0.5, linear=law is Law.LINEAR
    )
    motion_mm = np.random.default_rng(0).normal(0.0, 0.03, points_mm.shape)
    _, energy, _ = _point_stress(elements, displacement_gradient(elements, motion_mm))
    known = evaluate(elements, motion_mm).energy_Nmm
    assert float((energy * elements.weights_mm3).sum()) == pytest.approx(known, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("kind", [IndenterKind.CUBE, IndenterKind.CONE, IndenterKind.TORUS])
def test_edges_converge(kind: IndenterKind) -> None:
    found = pressed(SHEARED, indenter=Indenter(kind=kind, size_mm=4.0))
    assert found.converged.all()
    assert found.friction_ratio.max() <= 0.3 * (1 + 1e-12)
