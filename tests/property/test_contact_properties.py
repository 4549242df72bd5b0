"""What must hold for every press, on a small block and a short finger."""

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from sim.contact.engine.balances import Balances
from sim.contact.engine.relaxation import Relaxation
from sim.contact.motion.rests import INCREMENT_MM
from sim.contact.press import press_membrane
from sim.contact.readout.problem import make_problem
from sim.contact.solver.run import Run, relaxation_of
from sim.contact.studies.finger import at_45_degrees, penetration_and_balance, press_finger
from sim.contact.studies.specimens import flat_block
from workbench.core.base.errors import Cancelled, SolveError
from workbench.core.base.monitor import silent
from workbench.core.design.design import Elastomer
from workbench.core.press.indenter import Indenter, IndenterKind, IndenterMesh
from workbench.core.press.press import ContactSettings, Press
from workbench.core.press.press_case import PressCase
from workbench.core.result.sensing import Contact

pytestmark = pytest.mark.usefixtures("taichi_device")

BLOCK = flat_block(width_mm=10.0, height_mm=2.0, grid_mm=0.5, skin_mm=0.4)
PRESS = Press(target_mm=(0.0, 0.0, 2.0), depth_mm=0.4, frames=2)
SETTINGS = ContactSettings(active_radius_mm=6.0)


def press_block(
    press: Press = PRESS,
    *,
    indenter: Indenter | None = None,
    settings: ContactSettings = SETTINGS,
    monitor: Callable[..., None] = silent,
    **material: float,
) -> Contact:
    mesh, points = BLOCK
    soft = Elastomer(**material)
    sphere = indenter or Indenter(size_mm=4.0)
    return press_membrane(
        mesh,
        points,
        soft,
        PressCase(indenter=sphere, press=press, settings=settings),
        monitor=monitor,
    )


@pytest.fixture(scope="module")
def pressed() -> Contact:
    return press_block()


def test_same_press_twice_is_the_same_bit_by_bit(pressed: Contact) -> None:
    """No atomic sums: displacement, reaction and substeps are identical."""
    again = press_block()
    for field in dataclasses.fields(Contact):
        if field.name == "frame_seconds":
            continue
        first, second = getattr(pressed, field.name), getattr(again, field.name)
        assert np.array_equal(first, second), field.name


def test_force_is_proportional_to_youngs_modulus(pressed: Contact) -> None:
    """Statics has one modulus: doubling E doubles the force, to the settling tolerance."""
    stiff = press_block(young_MPa=0.29)
    np.testing.assert_allclose(stiff.reaction_N, 2.0 * pressed.reaction_N, rtol=2e-3, atol=2e-4)
    np.testing.assert_allclose(stiff.displacement_mm, pressed.displacement_mm, atol=2e-3)


def test_support_carries_the_reaction(pressed: Contact) -> None:
    """Support and elastomer left out carry the force within 1 %, the latter 5 % of it at most."""
    overlap, imbalance = penetration_and_balance(pressed)
    assert imbalance < 0.01
    cut = np.linalg.norm(pressed.cut_N[-1]) / np.linalg.norm(pressed.reaction_N[-1])
    assert 0.0 < cut < 0.05
    assert overlap < 0.02


def test_pressing_pushes_the_indenter_out(pressed: Contact) -> None:
    """The normal force is positive, grows with depth, and has no sideways part on a block."""
    assert 0.0 < pressed.normal_N[0] < pressed.normal_N[1]
    # The skin's triangles all lean one way, which is not symmetric: half a percent of the force.
    sideways = np.linalg.norm(pressed.reaction_N[-1, :2])
    assert sideways < 5e-3 * pressed.normal_N[-1]
    # The vertices next to the axis are 0.2 sqrt(2) mm off it, where the sphere is 0.02 mm higher;
    # the contact overlaps by up to 0.02 cell.
    assert pressed.displacement_mm[-1, :, 2].min() == pytest.approx(-0.38, abs=0.01)


def test_nothing_moves_outside_the_active_region(pressed: Contact) -> None:
    """Vertices whose cell is out of reach have a displacement of exactly 0."""
    outside = np.linalg.norm(BLOCK[0].outer.points_mm - [0.0, 0.0, 2.0], axis=1) > 6.5
    assert outside.any()
    assert not pressed.displacement_mm[:, outside].any()


def test_depth_zero_gives_no_force() -> None:
    """At first touch force, moment and displacement are exactly 0."""
    contact = press_block(dataclasses.replace(PRESS, depth_mm=0.0, frames=1))
    assert not contact.reaction_N.any()
    assert not contact.displacement_mm.any()
    assert contact.penetration_mm.max() < 1e-5


def test_friction_cone_holds_at_every_point() -> None:
    """Sliding by 0.6 mm under mu = 0.3: pointwise |t| / n is at most 0.3, and reached."""
    press = dataclasses.replace(PRESS, shear_mm=(0.6, 0.0))
    contact = press_block(press)
    # Single precision rounds the shortened slip.
    assert contact.friction_ratio.max() <= 0.3 * (1 + 1e-5)
    assert contact.friction_ratio[-1] == pytest.approx(0.3, rel=1e-4)
    assert contact.sliding[-1].any()
    assert contact.reaction_N[-1, 0] < -0.2 * contact.normal_N[-1]


def test_frictionless_contact_has_no_tangential_force() -> None:
    """With mu = 0 the pointwise ratio is 0 to rounding and the twisted sphere feels no moment."""
    press = dataclasses.replace(PRESS, twist_deg=30.0, frames=1)
    contact = press_block(press, friction=0.0)
    # Forces are in single precision and normals come from places in single precision.
    assert contact.friction_ratio.max() < 1e-5
    assert np.abs(contact.moment_Nmm[-1]).max() < 1e-3


def test_twist_is_resisted_by_friction() -> None:
    """Turning the sphere by +30 degrees gives a negative moment about the normal."""
    contact = press_block(dataclasses.replace(PRESS, twist_deg=30.0))
    assert contact.moment_Nmm[-1, 2] < -1e-2


@pytest.mark.parametrize("kind", [k for k in IndenterKind if k is not IndenterKind.MESH])
def test_every_shape_settles(kind: IndenterKind) -> None:
    """Each rounded shape presses 0.3 mm and settles in balance."""
    press = dataclasses.replace(PRESS, depth_mm=0.3, frames=1)
    contact = press_block(press, indenter=Indenter(kind=kind, size_mm=4.0))
    assert contact.normal_N[-1] > 0.0
    assert contact.residual[-1] < SETTINGS.tolerance
    assert penetration_and_balance(contact)[1] < 0.01


def test_mesh_of_a_sphere_presses_like_the_sphere(pressed: Contact) -> None:
    """An icosphere with facets sagging by 0.3 um gives the analytic force within 1 %."""
    import trimesh

    ball = trimesh.creation.icosphere(subdivisions=5, radius=2.0)
    mesh = IndenterMesh(
        points_mm=np.asarray(ball.vertices), faces=np.asarray(ball.faces, dtype=np.int32)
    )
    contact = press_block(indenter=Indenter(kind=IndenterKind.MESH, size_mm=4.0, mesh=mesh))
    np.testing.assert_allclose(contact.normal_N, pressed.normal_N, rtol=0.01)


@pytest.mark.parametrize(
    ("indenter", "depth_mm"),
    [(Indenter(kind=IndenterKind.CONE), 0.1), (Indenter(size_mm=1.0), 0.05)],
)
def test_small_tip_is_felt_wherever_it_lands(indenter: Indenter, depth_mm: float) -> None:
    """Forces on a vertex and between vertices are positive and within a factor of 1.6."""
    forces = [
        press_block(
            dataclasses.replace(PRESS, target_mm=(x, y, 2.0), depth_mm=depth_mm, frames=1),
            indenter=indenter,
        ).normal_N[-1]
        for x, y in ((0.2, 0.2), (0.2, 0.1), (0.0, 0.0))
    ]
    assert min(forces) > 0.0
    # The tip is finer than a cell of 0.5 mm, so its place on the grid is felt: measured 1.48.
    assert max(forces) < 1.6 * min(forces)


def test_settled_frame_is_the_one_that_was_tested(monkeypatch: pytest.MonkeyPatch) -> None:
    """A final evaluation out of balance is not accepted: the press goes on and tries again."""
    evaluate, seen = Relaxation.evaluate, []

    def spoilt(self: Relaxation, chosen: np.ndarray) -> Balances:
        seen.append(evaluate(self, chosen))
        excess = 1.0 if len(seen) == 1 else 0.0
        return dataclasses.replace(seen[-1], unbalanced_N=seen[-1].unbalanced_N + excess)

    monkeypatch.setattr(Relaxation, "evaluate", spoilt)
    contact = press_block(dataclasses.replace(PRESS, depth_mm=INCREMENT_MM, frames=1))
    assert len(seen) == 2
    assert contact.residual[-1] < SETTINGS.tolerance


def test_displacement_that_is_not_a_number_is_never_a_result(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Finite forces with one NaN node: the frame is unstable, however often it is tried."""
    displacement = Relaxation.displacement

    def spoilt(self: Relaxation, case: int = 0) -> np.ndarray:
        nodes = displacement(self, case)
        nodes[0] = np.nan
        return nodes

    monkeypatch.setattr(Relaxation, "displacement", spoilt)
    with pytest.raises(SolveError, match="became unstable 5 times"):
        press_block(dataclasses.replace(PRESS, frames=1))


@pytest.mark.slow
def test_azimuth_does_not_change_the_force() -> None:
    """The finger is round: 0 and 90 degrees agree to rounding of the skin, 45 to the lattice."""
    settings = ContactSettings(active_radius_mm=6.0)
    forces = [
        press_finger(
            at_45_degrees(depth_mm=0.5, azimuth_deg=azimuth_deg), settings=settings
        ).normal_N[-1]
        for azimuth_deg in (0.0, 90.0, 45.0)
    ]
    # A quarter turn maps the lattice onto itself; the skin's 236 columns too, but x is not y
    # in the order of sums.
    assert forces[1] == pytest.approx(forces[0], rel=5e-3)
    assert forces[2] == pytest.approx(forces[0], rel=0.03)


def test_running_out_of_substeps_is_reported() -> None:
    """20 substeps settle nothing: the error names the frame and the residual."""
    settings = dataclasses.replace(SETTINGS, max_substeps=20)
    with pytest.raises(SolveError, match="frame 1 of 2 has a residual of") as raised:
        press_block(settings=settings)
    assert raised.value.frame == 0
    assert raised.value.last_good == -1
    assert raised.value.residual > settings.tolerance


def test_the_measure_that_did_not_settle_is_named() -> None:
    """A residual of 9e-4 is below its limit of 1e-3: the net force over 5e-3 is what failed."""
    mesh, points = flat_block(width_mm=6.0, height_mm=2.0, grid_mm=0.5)
    problem = make_problem(
        mesh,
        points,
        Elastomer(),
        PressCase(indenter=Indenter(size_mm=4.0), press=PRESS, settings=SETTINGS),
    )
    run = Run(problem, relaxation_of([problem]), 0)
    limit = SETTINGS.tolerance
    assert "a residual of 9.0e-02" in run.unsettled(9e-2, 9e-2, 9e-2).message
    net = run.unsettled(0.9 * limit, 6e-3, 1e-5)
    assert "net force" in net.message
    assert "6.0e-03" in net.message
    assert "tolerance" not in net.hint
    assert "change of the reaction" in run.unsettled(0.9 * limit, 1e-3, 9e-4).message


def test_masses_doubled_in_a_stall_come_back_frame_by_frame() -> None:
    """Doubled twice, halved three times: 1, 2, 4, 2, 1, 1."""
    mesh, points = flat_block(width_mm=6.0, height_mm=2.0, grid_mm=0.5)
    problem = make_problem(
        mesh,
        points,
        Elastomer(),
        PressCase(indenter=Indenter(size_mm=4.0), press=PRESS, settings=SETTINGS),
    )
    relaxation, seen = relaxation_of([problem]), []
    for step in (relaxation.burden, relaxation.burden, *[relaxation.relieve] * 3):
        step(np.ones(1, bool) if step == relaxation.burden else 0)
        seen.append(float(relaxation.mass_scale[0]))
    assert seen == [2.0, 4.0, 2.0, 1.0, 1.0]


def test_monitor_can_stop_the_press() -> None:
    """Progress grows to 1 and a raised Cancelled comes through."""
    seen: list[float] = []

    def watch(fraction: float, note: str = "") -> None:
        seen.append(fraction)
        if len(seen) == 4:
            raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        press_block(monitor=watch)
    assert seen == sorted(seen)
    assert len(seen) == 4
