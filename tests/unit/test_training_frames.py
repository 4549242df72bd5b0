"""What a network learns from: orientations that are exact physics, scales, and refused fields."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from sim.forces.network.spec import PAPER, Target
from sim.forces.network.turns import SYMMETRIC, turn_matrix, value_matrix
from sim.forces.network.voxels import VOXEL_PER_SPACING
from sim.forces.training.fields import Fields, mean_size, rms_of_nonzero
from sim.forces.training.frames import frames_of
from sim.forces.training.settings import OUR_VOXEL, PRESETS, TrainingSettings, rate_factor
from tests.unit.made_presses import SPEC, dent, force_of, made_presses, sheet
from workbench.core.base.errors import DesignError, SolveError
from workbench.learning.dataset.cases import Split


def whole(six: np.ndarray) -> np.ndarray:
    """A stress as a matrix."""
    matrix = np.zeros((3, 3))
    for place, value in zip(SYMMETRIC, six, strict=True):
        matrix[place] = matrix[place[::-1]] = value
    return matrix


@pytest.mark.parametrize("turn", range(8))
def test_turns_keep_lengths_and_the_axis(turn: int) -> None:
    """T^t T = 1, z stays z, every second one mirrors, the first changes nothing."""
    matrix = turn_matrix(turn, 8)
    assert np.allclose(matrix.T @ matrix, np.eye(3), atol=1e-15)
    assert np.array_equal(matrix[2], [0.0, 0.0, 1.0])
    assert round(np.linalg.det(matrix)) == (-1 if turn % 2 else 1)
    assert turn or np.array_equal(matrix, np.eye(3))


def test_a_turned_stress_is_t_s_t() -> None:
    """The six numbers of T S T^t, against the product of whole matrices."""
    rng = np.random.default_rng(1)
    for turn in range(5):
        matrix, six = turn_matrix(turn, 5), rng.normal(size=6)
        found = value_matrix(matrix, Target.STRESS) @ six
        assert np.allclose(whole(found), matrix @ whole(six) @ matrix.T, atol=1e-14)


def test_turned_vectors_are_what_the_turned_sensor_sees() -> None:
    """A law that knows no direction: force of the turned dent = turned force of the dent."""
    presses = made_presses(2)
    fields = presses.fields(Target.FORCE, [0, 1])
    frames = frames_of(
        presses.skins[0].points_mm,
        voxel_mm=0.75,
        spec=SPEC,
        target=Target.FORCE,
        turns=6,
        device="cpu",
    )
    for frame in frames:
        turned = fields.inputs[0] @ frame.vectors.numpy().T
        expected = fields.targets[0] @ frame.values.numpy().T
        assert np.allclose(force_of(turned), expected, atol=1e-6)


def test_each_turn_has_voxels_of_the_turned_points() -> None:
    """A sheet turned by 45 degrees lies in other voxels; each vertex keeps one of its own."""
    points_mm, _ = sheet()
    frames = frames_of(
        points_mm, voxel_mm=0.7, spec=SPEC, target=Target.FORCE, turns=8, device="cpu"
    )
    counts = [frame.voxels.count for frame in frames]
    assert counts[0] == len(points_mm)
    extents = [frame.voxels.coordinates.amax(0).tolist() for frame in frames]
    # The diagonal is longer than the edge by the root of two.
    assert extents[1][1] > 1.3 * extents[0][1]
    ones = torch.ones(len(points_mm), 1, 1)
    assert all(torch.equal(f.voxels.to_points(f.voxels.mean(ones)), ones) for f in frames)


def test_scale_is_of_what_is_not_zero() -> None:
    """3 and 4 among zeros: sqrt(12.5); nothing but zeros: 0."""
    values = np.zeros((2, 5, 3), np.float32)
    values[0, 1, 2], values[1, 4, 0] = 3.0, -4.0
    assert rms_of_nonzero(values) == pytest.approx(12.5**0.5)
    assert rms_of_nonzero(np.zeros((2, 5, 3), np.float32)) == 0.0
    assert mean_size(values) == pytest.approx(7.0 / 30.0)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_field_that_is_not_finite_is_refused_by_name(bad: float) -> None:
    """Never averaged over: the message names sample, field and how many values."""
    good = made_presses(6).fields(Target.FORCE, [0, 1, 2])
    targets = good.targets.copy()
    targets[1, 7, 2] = bad
    with pytest.raises(SolveError, match=r"target of dent0 frame 2 has 1 of 432 values"):
        Fields(inputs=good.inputs, targets=targets, sizes=good.sizes, names=good.names)


def test_rate_warms_up_and_falls_along_a_cosine() -> None:
    """Linear to 1 in the first tenth, half way down in the middle, a hundredth at the end."""
    settings = TrainingSettings(name="x", spec=SPEC, warm_up=0.1, cosine=True)
    factors = [rate_factor(step, 1000, settings) for step in range(1000)]
    assert factors[49] == pytest.approx(0.5)
    assert max(factors) == pytest.approx(1.0) and factors.index(max(factors)) in (99, 100)
    assert factors[550] == pytest.approx(0.505)
    assert factors[-1] == pytest.approx(0.01, abs=1e-4)
    flat = TrainingSettings(name="x", spec=SPEC)
    assert {rate_factor(step, 1000, flat) for step in range(1000)} == {1.0}


def test_presets_are_as_published_and_as_the_voxels_say() -> None:
    """Adam 1e-3, batch 32, 100 epochs, 0.11 mm on 0.9 mm; ours has the voxels of `voxels`."""
    paper = PRESETS["paper"]
    assert (paper.spec, paper.rate, paper.batch, paper.epochs) == (PAPER, 1e-3, 32, 100)
    assert paper.voxel_per_spacing * 0.9 == pytest.approx(0.11)
    assert OUR_VOXEL == VOXEL_PER_SPACING == PRESETS["small"].voxel_per_spacing


def test_refused_settings_name_their_limits() -> None:
    """A rate of 0 learns nothing."""
    with pytest.raises(DesignError, match=r"rate 0 is outside 1e-07 to 1"):
        TrainingSettings(name="x", spec=SPEC, rate=0.0)


def test_sparse_fields_come_back_dense() -> None:
    """All parts of all states, bit by bit, and only vertices that are not zero are kept."""
    presses = made_presses(6)
    points_mm, _ = sheet()
    rng = np.random.default_rng(0)
    assert presses.cases(Split.TRAIN) == ["dent0", "dent1", "dent2"]
    field = presses.parts["mpm.displacement_mm"]
    assert len(field.index) < 0.5 * len(presses.states) * len(points_mm)
    first_mm = dent(points_mm, rng)
    fields = presses.fields(Target.FORCE, [1])
    assert np.array_equal(fields.inputs[0], first_mm.astype(np.float32))
    assert np.array_equal(fields.targets[0], force_of(first_mm).astype(np.float32))
    raw = presses.raw_errors(Target.FORCE, [1])
    assert raw is not None and raw[0] == pytest.approx(0.1 * fields.zero_mae, rel=1e-5)
    assert presses.raw_errors(Target.STRESS, [1]) is None


def test_the_first_cases_are_of_all_skins() -> None:
    """A learning curve over several membranes grows on all of them: one case of each in turn."""
    presses = made_presses(24, edges=(12, 15, 14))
    skin_of = {state.case: state.skin for state in presses.states}
    assert [skin_of[case] for case in presses.cases(Split.TRAIN)[:6]] == [0, 1, 2, 0, 1, 2]
    assert sorted(presses.cases(Split.TRAIN)) == sorted(
        {state.case for state in presses.states if state.split is Split.TRAIN}
    )


def test_fields_are_of_one_skin() -> None:
    """States of two skins have no common vertices: asking for both at once is refused."""
    presses = made_presses(12, edges=(12, 15))
    groups = presses.by_skin(range(len(presses.states)))
    assert [len(states) for states in groups.values()] == [12, 12]
    assert presses.fields(Target.FORCE, groups[1], skin=1).inputs.shape[1] == 225
    with pytest.raises(ValueError, match="of skin 0"):
        presses.fields(Target.FORCE, [*groups[0], groups[1][0]])
