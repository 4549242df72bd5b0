"""Networks that are given the contact solver's force, and add to its field."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from sim.forces.network.inputs import given_field
from sim.forces.network.minkunet import arrays_of, new_network
from sim.forces.network.predictor import Precision, Predictor
from sim.forces.network.spec import Target
from sim.forces.network.weights import (
    NetworkWeights,
    load_weights,
    weights_from_bytes,
    weights_to_bytes,
)
from sim.forces.training.frames import turn_matrix
from tests.made_weights import SPEC, tiny_weights
from tests.unit.made_presses import SETTINGS, made_presses
from workbench.core.base.errors import DesignError, StoreError
from workbench.learning.dataset.cases import Split
from workbench.learning.training.beginning import begin
from workbench.learning.training.learn import train
from workbench.learning.training.plan import Plan, Resources
from workbench.learning.training.presses import Presses
from workbench.learning.training.results import score, single_predictor

PRESSES = made_presses(12)
SKIN = PRESSES.skins[0]
CPU = Resources(device="cpu")
BOTH = dataclasses.replace(SETTINGS, takes_force=True, corrects=True)
TARGETS = (Target.FORCE, Target.DISPLACEMENT)


def correcting(target: Target, *, silent: bool, spacing_mm: float = 1.0) -> NetworkWeights:
    """A network of six channels; a silent one adds nothing."""
    spec = dataclasses.replace(SPEC, input_channels=6)
    arrays = dict(arrays_of(new_network(spec, seed=3)))
    if silent:
        arrays |= {name: np.zeros_like(arrays[name]) for name in ("last.weight", "last.bias")}
    return dataclasses.replace(
        tiny_weights(target=target),
        spec=spec,
        arrays=arrays,
        force_scale_N=0.01,
        corrects=True,
        spacing_mm=spacing_mm,
    )


def fields(count: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Displacement [mm] and force [N] of some points."""
    rng = np.random.default_rng(seed)
    return (
        rng.normal(0.0, 0.3, (count, 3)).astype(np.float32),
        rng.normal(0.0, 0.01, (count, 3)).astype(np.float32),
    )


@pytest.mark.parametrize("target", TARGETS)
def test_a_silent_correction_is_the_solver_s_own_field(target: Target) -> None:
    weights = correcting(target, silent=True)
    moved_mm, force_N = fields(len(SKIN.points_mm), 0)
    given = given_field(weights, moved_mm, force_N)
    assert given.shape == (len(moved_mm), 6)
    found = Predictor(weights, SKIN.points_mm, precision=Precision.SINGLE).predict(given)
    np.testing.assert_array_equal(found, force_N if target is Target.FORCE else moved_mm)


def test_a_correction_is_added_to_what_the_network_says() -> None:
    """With `corrects` or without, the same network differs by the solver's field."""
    weights = correcting(Target.FORCE, silent=False)
    moved_mm, force_N = fields(len(SKIN.points_mm), 1)
    given = given_field(weights, moved_mm, force_N)
    whole, alone = (
        Predictor(each, SKIN.points_mm, precision=Precision.SINGLE).predict(given)
        for each in (weights, dataclasses.replace(weights, corrects=False))
    )
    assert np.abs(alone).max() > 1e-3
    np.testing.assert_allclose(whole - alone, force_N, atol=1e-6)


def test_force_enters_divided_by_the_ratio_of_moduli() -> None:
    """A gel twice as stiff is seen as the one of the training."""
    weights = correcting(Target.FORCE, silent=False)
    moved_mm, force_N = fields(50, 2)
    stiff = given_field(weights, moved_mm, 2.0 * force_N, factor=2.0)
    np.testing.assert_allclose(stiff, given_field(weights, moved_mm, force_N), rtol=1e-6)
    plain = tiny_weights()
    assert given_field(plain, moved_mm, force_N) is moved_mm


def test_a_file_keeps_scale_and_kind_and_older_files_have_neither() -> None:
    weights = correcting(Target.FORCE, silent=True)
    again = weights_from_bytes(*weights_to_bytes(weights))
    assert (again.force_scale_N, again.corrects, again.input_scale) == (
        0.01,
        True,
        (0.5, 0.5, 0.5, 0.01, 0.01, 0.01),
    )
    old = tiny_weights()
    assert not old.takes_force and not old.corrects and old.input_scale == (0.5, 0.5, 0.5)
    with pytest.raises(StoreError, match="scale of the force"):
        weights_to_bytes(dataclasses.replace(weights, force_scale_N=-1.0))


@pytest.mark.parametrize("target", TARGETS)
def test_training_begins_at_the_solver_s_error(target: Target) -> None:
    """Before its first epoch a correction scores what the contact solver does, on every split."""
    plan = Plan(settings=BOTH, target=target, seed=4)
    states = PRESSES.of_split(Split.TRAIN)
    begun = begin(PRESSES, states, plan, CPU)
    assert begun.corrects and begun.network.spec.input_channels == 6
    weights = begun.weights(arrays_of(begun.network), {})
    told = score(PRESSES, weights, states, [single_predictor(weights, SKIN, "cpu")], 4)
    assert told["mae"] == pytest.approx(told["mpm_mae"], rel=1e-5)
    assert begun.unit_mae == pytest.approx(told["mpm_mae"], rel=1e-5)
    assert begun.validation_zero_mae > 0.0


def test_errors_of_an_epoch_are_those_of_its_weights(tmp_path: Path) -> None:
    """What the trainer measures of the correction is what the file scores as a whole field."""
    done = train(PRESSES, Plan(settings=BOTH, target=Target.FORCE, seed=4), tmp_path, resources=CPU)
    best = min(row["validation_mae"] for row in done.rows)
    assert done.scores["validation"]["mae"] == pytest.approx(best, rel=2e-3)
    weights = load_weights(done.weights)
    assert weights.corrects and weights.takes_force


def test_turned_states_turn_both_vectors() -> None:
    """The fields of a state with force are six numbers that turn three by three."""
    both = PRESSES.fields(Target.FORCE, [0], takes_force=True)
    plain = PRESSES.fields(Target.FORCE, [0])
    np.testing.assert_array_equal(both.inputs[..., :3], plain.inputs)
    matrix = turn_matrix(3, 8)
    turned = both.inputs.reshape(*both.inputs.shape[:2], 2, 3) @ matrix.T
    np.testing.assert_allclose(turned[..., 0, :], plain.inputs @ matrix.T)


def test_targets_are_what_is_missing() -> None:
    whole, missing = (PRESSES.fields(Target.FORCE, [0, 1], corrects=c) for c in (False, True))
    raw = PRESSES.parts["mpm.contact_force_N"].dense([0, 1], len(SKIN.points_mm))
    np.testing.assert_allclose(missing.targets, whole.targets - raw, atol=1e-9)
    assert PRESSES.zero_mae(Target.FORCE, [0, 1]) == pytest.approx(whole.zero_mae, rel=1e-6)


def test_data_without_the_solver_s_force_are_refused() -> None:
    parts = {name: part for name, part in PRESSES.parts.items() if name != "mpm.contact_force_N"}
    lacking: Presses = dataclasses.replace(PRESSES, parts=parts)
    with pytest.raises(DesignError, match=r"holds no mpm\.contact_force_N"):
        lacking.fields(Target.DISPLACEMENT, [0], takes_force=True)


def test_tuning_a_correction_scales_force_and_output_by_the_ratio(tmp_path: Path) -> None:
    """Twice as stiff: what enters looks the same to the network, what it adds is doubled."""
    done = train(PRESSES, Plan(settings=BOTH, target=Target.FORCE, seed=4), tmp_path, resources=CPU)
    base = load_weights(done.weights)
    stiff = made_presses(12, young=0.2)
    plan = Plan(settings=SETTINGS, target=Target.FORCE, base=base, base_name=done.weights.name)
    states = stiff.of_split(Split.TRAIN)
    begun = begin(stiff, states, plan, CPU)
    assert begun.corrects
    assert begun.scales.force_N == pytest.approx(2.0 * base.force_scale_N)
    assert begun.scales.output == pytest.approx(2.0 * base.output_scale[0])
    soft, hard = (
        score(presses, weights, states, [single_predictor(weights, SKIN, "cpu")], 4)["mae"]
        for presses, weights in (
            (PRESSES, base),
            (stiff, begun.weights(arrays_of(begun.network), {})),
        )
    )
    assert hard == pytest.approx(2.0 * soft, rel=1e-4)
