"""Learned forces of a press in closed form: networks whose last layer gives the same everywhere."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from sim.forces.acquaintance import Acquaintance
from sim.forces.learned import Known, Pair, learned_forces
from sim.forces.network.predictor import Precision, Predictor
from sim.forces.network.spec import Target
from tests.made_weights import tiny_weights
from workbench.core.base.errors import Cancelled, StoreError
from workbench.core.result.force_field import ForceField, Source
from workbench.core.result.results import MembraneMesh, Skin
from workbench.core.result.sensing import Contact

FRAMES = 3
FORCE_N = np.array([1e-3, -2e-3, -5e-3])
"""What the constant network gives every vertex."""


def patch(count: int) -> Skin:
    """A square of 8 mm at z = 0 in triangles of one `count`-th."""
    side = np.linspace(0.0, 8.0, count + 1)
    x, y = np.meshgrid(side, side, indexing="ij")
    number = np.arange((count + 1) ** 2).reshape(count + 1, count + 1)
    a, b = number[:-1, :-1].ravel(), number[1:, :-1].ravel()
    c, d = number[1:, 1:].ravel(), number[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)]).astype(np.int32)
    points = np.stack([x.ravel(), y.ravel(), np.zeros(x.size)], axis=1)
    return Skin(points_mm=points, faces=faces, normals=np.tile([0.0, 0.0, 1.0], (x.size, 1)))


def membrane(count: int) -> MembraneMesh:
    skin = patch(count)
    return MembraneMesh(hexes=None, outer=skin, inner=skin, cavity=skin)


def contact(mesh: MembraneMesh) -> Contact:
    """A press whose skin goes down by 0.1 mm a frame, under an object 2 mm above the middle."""
    count = len(mesh.outer.points_mm)
    displacement = np.zeros((FRAMES, count, 3), np.float32)
    displacement[:, :, 2] = -0.1 * np.arange(1, FRAMES + 1)[:, None]
    pose = np.tile([4.0, 4.0, 2.0, 1.0, 0.0, 0.0, 0.0], (FRAMES, 1))
    return Contact(
        displacement_mm=displacement,
        reaction_N=np.zeros((FRAMES, 3)),
        moment_Nmm=np.zeros((FRAMES, 3)),
        indenter_pose=pose,
        residual=np.zeros(FRAMES),
        penetration_mm=np.zeros(FRAMES),
        support_N=np.zeros((FRAMES, 3)),
        cut_N=np.zeros((FRAMES, 3)),
        friction_ratio=np.zeros(FRAMES),
        sliding=np.zeros((FRAMES, count), bool),
        target_mm=np.array([4.0, 4.0, 0.0]),
        normal=np.array([0.0, 0.0, 1.0]),
        tangent_u=np.array([1.0, 0.0, 0.0]),
        grid_mm=0.5,
        active_radius_mm=9.0,
        particles=1,
        substeps=1,
        device="cpu",
    )


def known(value: Any = FORCE_N, target: Target = Target.FORCE, **fields: Any) -> Known:
    """A network that gives `value` everywhere, or with None one that was never trained."""
    return Known(
        name=f"tiny-{target}.weights",
        weights=tiny_weights(value, target),
        acquaintance=Acquaintance(**fields),
    )


def found(design: int, source: int, *used: Known, **options: Any) -> ForceField:
    """Forces of the press on a membrane of so many cells, by networks of another."""
    mesh = membrane(design)
    return learned_forces(mesh, contact(mesh), membrane(source), Pair(*used), **options)


def test_forces_of_every_vertex_add_up_on_the_design_s_skin() -> None:
    """81 vertices of the network with a force each: 81 times that on 17 x 17 of the design."""
    field = found(16, 8, known())
    assert field.source is Source.LEARNED
    assert field.contact_force_N.shape == (FRAMES, 17 * 17, 3)
    assert np.allclose(field.contact_force_N.sum(axis=1), 81 * FORCE_N, rtol=1e-5)
    assert np.allclose(field.reaction_N, -81 * FORCE_N, rtol=1e-6)
    assert np.isnan(field.residual).all() and np.isnan(field.balance).all()
    assert field.converged.all() and len(field.frame_seconds) == FRAMES


def test_moment_is_about_the_object() -> None:
    """All forces together act in the middle, 2.1 mm and more below the object: -r x f."""
    field = found(8, 8, known())
    for frame in range(FRAMES):
        arm_mm = np.array([0.0, 0.0, -2.0 - 0.1 * (frame + 1)])
        expected = -np.cross(arm_mm, 81 * FORCE_N)
        assert np.allclose(field.moment_Nmm[frame], expected, rtol=1e-5)


def test_pressure_is_the_force_against_the_normal_per_area() -> None:
    """5 mN downward on the 1 mm2 of an inner vertex: 5 kPa."""
    field = found(8, 8, known())
    inner = (np.abs(patch(8).points_mm[:, :2] - 4.0) < 3.5).all(axis=1)
    assert np.allclose(field.pressure_MPa[:, inner], 5e-3, rtol=1e-5)


def test_displacement_is_the_solver_s_unless_a_network_gives_one() -> None:
    """Without such weights to the last bit; with them what they say, on the design's skin."""
    mesh = membrane(16)
    pressed = contact(mesh)
    alone = learned_forces(mesh, pressed, membrane(8), Pair(known()))
    assert alone.displacement_mm is pressed.displacement_mm
    moved_mm = np.array([0.01, 0.0, -0.2])
    both = found(16, 8, known(), known(moved_mm, Target.DISPLACEMENT))
    assert np.allclose(both.displacement_mm, moved_mm, atol=1e-6)
    assert both.solver.startswith("tiny-force.weights and tiny-displacement.weights on cpu, ")


def test_the_network_is_given_the_displacement_of_its_own_points() -> None:
    """A uniform displacement is the same on any points: equal to the predictor there."""
    field = found(16, 8, known(None))
    skin = patch(8)
    one = known(None).weights
    predictor = Predictor(one, skin.points_mm, faces=skin.faces, precision=Precision.SINGLE)
    for frame in range(FRAMES):
        given_mm = np.tile([0.0, 0.0, -0.1 * (frame + 1)], (81, 1)).astype(np.float32)
        expected_N = predictor.predict(given_mm).sum(axis=0)
        assert np.abs(expected_N).max() > 1e-3
        assert np.allclose(field.reaction_N[frame], -expected_N, rtol=1e-4, atol=1e-6)


def test_another_stiffness_scales_every_force() -> None:
    """Factor 3: forces, reaction, moment and pressure, but no displacement."""
    plain, scaled = found(8, 8, known()), found(8, 8, known(factor=3.0, note="E is tripled"))
    for name in ("contact_force_N", "reaction_N", "moment_Nmm", "pressure_MPa"):
        assert np.allclose(getattr(scaled, name), 3.0 * getattr(plain, name), rtol=1e-5), name
    assert np.array_equal(scaled.displacement_mm, plain.displacement_mm)
    assert scaled.note == "E is tripled" and scaled.notice == ""


def test_doubts_of_both_networks_are_said_once() -> None:
    """A reason that both have stands once; what to do about it is not the network's to say."""
    two = (known(reasons=("soft", "deep")), known(FORCE_N, Target.DISPLACEMENT, reasons=("soft",)))
    assert found(8, 8, *two).notice == "soft; deep"


def test_weights_of_another_target_are_refused() -> None:
    """A displacement network in place of a force network, and the other way round."""
    with pytest.raises(StoreError, match="predicts displacement, not force") as caught:
        found(8, 8, known(target=Target.DISPLACEMENT))
    assert "-force-" in caught.value.hint
    with pytest.raises(StoreError, match="predicts force, not displacement"):
        found(8, 8, known(), known())


def test_a_prediction_can_be_stopped_between_two_frames() -> None:
    """The monitor is told of each frame, and what it raises ends the work."""

    def stop(fraction: float, note: str = "") -> None:
        if note == "frame 2 of 3":
            raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        found(8, 8, known(), monitor=stop)


def test_the_number_of_threads_is_given_back() -> None:
    """Prediction computes in one thread and leaves PyTorch as it was."""
    import torch

    before = torch.get_num_threads()
    torch.set_num_threads(2)
    try:
        found(8, 8, known())
        assert torch.get_num_threads() == 2
    finally:
        torch.set_num_threads(before)


def test_fields_that_nobody_predicts_stay_unknown() -> None:
    """No stress, energy, slip or inner skin on another mesh either: length 0, not zeros."""
    field = found(16, 8, known())
    for name in ("cauchy_MPa", "energy_MPa", "slip_mm", "sliding", "inner_mm"):
        assert len(getattr(field, name)) == 0, name
    assert field.spacing_mm == 0.0
