"""Scoring on held-out samples: what is scored, how it is grouped, and what is refused."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.forces.network.minkunet import arrays_of, new_network
from sim.forces.network.spec import FIELDS, NetworkSpec, Target
from sim.forces.network.weights import NetworkWeights
from tests.synthetic_presses import made_up, made_up_sample
from workbench.core.base.errors import Cancelled, DesignError, SolveError
from workbench.learning.dataset.cases import Split
from workbench.learning.dataset.folder import DataSet
from workbench.learning.dataset.sample import to_bytes
from workbench.learning.evaluation import evaluate, scoring
from workbench.learning.evaluation.evaluate import Named, evaluate_all, evaluate_field, tables
from workbench.learning.evaluation.groups import by_station, station_of
from workbench.learning.evaluation.leaks import expect_no_leak
from workbench.learning.evaluation.scoring import Learned, Way, compared, grouped, scored_states
from workbench.learning.evaluation.sources import expect_held_out, states
from workbench.system.whole_files import write_atomically

TINY = NetworkSpec(name="tiny", planes=(4, 4, 6, 6, 6, 4, 4, 4), stem_planes=4, stem_edge=3)
SEEN = ["cross", "hexagon", "sphere"]


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> DataSet:
    """Forty cases on a pad; the flower is the unseen object."""
    return made_up(tmp_path_factory.mktemp("pad"))


def untrained(data: DataSet, target: Target = Target.FORCE, **card: Any) -> NetworkWeights:
    """A network that was never trained, with the card of one that was trained on the data."""
    about = {
        "dataset": {"key": data.key, "design": data.manifest["recipe"]["design"]},
        "young_MPa": data.manifest["recipe"]["design"]["material"]["young_MPa"],
        "indenters": SEEN,
    }
    return NetworkWeights(
        spec=TINY,
        arrays=arrays_of(new_network(TINY, seed=1)),
        target=target,
        input_scale_mm=0.3,
        output_scale=(1e-4,) * 3,
        voxel_per_spacing=0.75,
        spacing_mm=0.48,
        card={**about, **card},
    )


def oracle(data: DataSet, target: Target) -> Learned:
    """Answers with the finite elements' own field, found by the displacement that it is given."""
    known = {}
    for case, frame in states(data):
        sample = data.sample(case, frame)
        assert sample.mpm is not None and sample.fem is not None
        known[sample.mpm.displacement_mm.tobytes()] = getattr(sample.fem, FIELDS[target])
    return lambda mpm: known[mpm.displacement_mm.tobytes()]


def test_only_test_and_unseen_cases_are_scored(data: DataSet) -> None:
    """Each state once: repeats of an approach are left out, training cases too."""
    chosen = expect_held_out(data, "data")
    assert {case.split for case, _ in chosen} == {Split.TEST, Split.UNSEEN}
    assert all(frame >= case.first_new for case, frame in chosen)
    expected = sum(
        case.frames - case.first_new
        for split in (Split.TEST, Split.UNSEEN)
        for case in data.cases(split)
    )
    assert len({(case.id, frame) for case, frame in chosen}) == len(chosen) == expected


@pytest.mark.parametrize("target", FIELDS)
def test_a_network_that_equals_finite_elements_scores_nothing(
    data: DataSet, target: Target
) -> None:
    """Errors and both ratios are 0; zero over zero is 1; the contact solver is as it was made."""
    rows = scored_states(data, expect_held_out(data, "data"), target, oracle(data, target))
    found = compared(rows)
    assert found.learned.mae == 0.0 == found.learned.worst
    assert found.error_ratio(Way.LEARNED, Way.MPM) == 0.0
    assert found.error_ratio(Way.LEARNED, Way.ZERO) == 0.0
    assert found.error_ratio(Way.ZERO, Way.ZERO) == 1.0
    # Made a fifth too low and 1.3 times as wide: wrong, and better than nothing.
    assert 0.1 < found.error_ratio(Way.MPM, Way.ZERO) < 0.9


def test_the_error_is_that_of_numpy_over_everything(data: DataSet) -> None:
    """Mean over samples, points and axes at once, for the raw contact solver."""
    chosen = expect_held_out(data, "data")
    rows = scored_states(data, chosen, Target.FORCE, oracle(data, Target.FORCE))
    samples = [data.sample(case, frame) for case, frame in chosen]
    mpm = np.array([s.mpm.contact_force_N for s in samples if s.mpm], np.float64)
    fem = np.array([s.fem.contact_force_N for s in samples if s.fem], np.float64)
    found = compared(rows)
    assert found.ways[Way.MPM].mae == pytest.approx(np.abs(mpm - fem).mean(), rel=1e-12)
    assert found.ways[Way.ZERO].mae == pytest.approx(np.abs(fem).mean(), rel=1e-12)
    assert found.learned.peak == pytest.approx(np.linalg.norm(fem, axis=2).max(), rel=1e-12)
    # The press of a pad has U, V and normal along X, Y and Z.
    off = np.abs((mpm - fem).sum(axis=1)).mean(axis=0)
    assert found.ways[Way.MPM].total_mae == pytest.approx(off.tolist(), rel=1e-9)


def test_peaks_are_pressures_and_disc_forces(data: DataSet) -> None:
    """Right by the oracle, -100 % of zero, too low of the solver, which was made so."""
    chosen = expect_held_out(data, "data")
    rows = scored_states(data, chosen, Target.FORCE, oracle(data, Target.FORCE))
    found = compared(rows).ways
    for bias in ("peak_pressure_bias", "peak_disc_bias"):
        assert getattr(found[Way.LEARNED], bias) == 0.0
        assert getattr(found[Way.ZERO], bias) == -1.0
        assert -0.6 < getattr(found[Way.MPM], bias) < -0.15
    result = evaluate.FieldResult(target=Target.FORCE, weights="w", samples=tuple(rows))
    told = tables(result)["peaks"]
    assert len(told) == len(rows)
    assert told[0]["learned"] == told[0]["fem"] != told[0]["mpm"]
    assert told[0]["fem"].keys() == {"peak_MPa", "peak_disc_N"}
    moved = scored_states(data, chosen[:1], Target.DISPLACEMENT, oracle(data, Target.DISPLACEMENT))
    result = evaluate.FieldResult(target=Target.DISPLACEMENT, weights="w", samples=tuple(moved))
    assert tables(result)["peaks"] == []


def test_shears_stand_apart_from_presses(data: DataSet) -> None:
    """Two press frames by 0.2 mm, two shear frames by 0.1 mm, at full depth."""
    chosen = expect_held_out(data, "data")
    rows = scored_states(data, chosen, Target.FORCE, oracle(data, Target.FORCE))
    result = evaluate.FieldResult(target=Target.FORCE, weights="w", samples=tuple(rows))
    told = tables(result)
    assert list(told["press_depths_mm"]) == ["0.2", "0.4"]
    assert list(told["shear_ways_mm"]) == ["0.1", "0.2"]
    counts = {name: one["samples"] for name, one in told["motions"].items()}
    assert sum(counts.values()) == len(rows) == told["all"]["samples"]
    assert sum(one["samples"] for one in told["press_stations"].values()) == counts["press"]
    assert sum(one["samples"] for one in told["shear_stations"].values()) == counts["shear"]
    assert told["splits"]["unseen"]["samples"] == told["indenters"]["flower"]["samples"]
    # The deeper press is twice as strong, so zero errs twice as much.
    shallow, deep = (told["press_depths_mm"][name]["zero"]["mae"] for name in ("0.2", "0.4"))
    cases = {name: told["press_depths_mm"][name]["samples"] for name in ("0.2", "0.4")}
    assert cases["0.2"] == cases["0.4"]
    assert deep == pytest.approx(2.0 * shallow, rel=1e-4)


def test_stations_are_in_the_order_of_the_path(data: DataSet) -> None:
    """Rings of the pad from the middle: 0, 1.5, 1.5 sqrt 2, 3, ... mm."""
    rows = scored_states(data, states(data), Target.FORCE, oracle(data, Target.FORCE))
    names = list(grouped(by_station(rows), station_of))
    assert names[:3] == ["0.0 mm", "1.5 mm", "2.1 mm"]
    ways_mm = [float(name.removesuffix(" mm")) for name in names]
    assert ways_mm == sorted(ways_mm)


def test_weights_are_scored_beside_the_nulls(data: DataSet) -> None:
    """An untrained network is told as what it is, in the order force, displacement."""
    weights = [
        Named(name=target.value, weights=untrained(data, target))
        for target in (Target.DISPLACEMENT, Target.FORCE)
    ]
    found = evaluate_all(data, weights, name="data")
    assert list(found) == [Target.FORCE, Target.DISPLACEMENT]
    one = compared(found[Target.FORCE].of(Split.UNSEEN))
    assert one.error_ratio(Way.LEARNED, Way.MPM) > 1.0
    assert found[Target.FORCE].notes == ()


def test_another_spacing_is_noted(data: DataSet) -> None:
    """Trained on points 0.9 mm apart, scored on 0.48 mm."""
    weights = dataclasses.replace(untrained(data), spacing_mm=0.9)
    found = evaluate_field(data, Named(name="w", weights=weights), name="data")
    assert "0.90 mm apart, scored on 0.48 mm" in " ".join(found.notes)


def test_a_prediction_that_is_not_finite_is_refused(data: DataSet) -> None:
    """NaN stops the evaluation, and is not averaged over."""
    with pytest.raises(SolveError, match="not finite"):
        scored_states(
            data, states(data), Target.FORCE, lambda mpm: np.full_like(mpm.displacement_mm, np.nan)
        )


def test_a_sample_that_was_not_settled_is_left_out_and_told(tmp_path: Path) -> None:
    """One of the contact solver's, of an unseen case."""
    data = made_up(tmp_path, cases=8)
    case, frame = states(data)[-1]
    sample = made_up_sample(data, case, frame)
    assert sample.mpm is not None
    loose = dataclasses.replace(sample.mpm, converged=False)
    content = to_bytes(dataclasses.replace(sample, mpm=loose))
    write_atomically(data.path(case, frame), content)
    found = evaluate_field(data, Named(name="w", weights=untrained(data)), name="data")
    assert len(found.samples) == len(states(data)) - 1
    assert found.notes == ("1 samples that a solver did not settle: left out",)


def test_an_evaluation_can_be_cancelled(data: DataSet) -> None:
    """The monitor's Cancelled ends it between two samples."""
    told: list[float] = []

    def monitor(fraction: float, note: str = "") -> None:
        told.append(fraction)
        if len(told) == 3:
            raise Cancelled("stopped")

    with pytest.raises(Cancelled):
        evaluate_field(data, Named(name="w", weights=untrained(data)), name="data", monitor=monitor)
    assert told == sorted(told) and len(told) == 3


def test_stress_has_no_raw_answer_to_stand_beside(data: DataSet) -> None:
    """Its network is refused by name."""
    weights = dataclasses.replace(untrained(data), target=Target.STRESS)
    with pytest.raises(DesignError, match="weights for stress"):
        scoring.field_target(weights)


def leak(data: DataSet, weights: NetworkWeights, *splits: Split) -> None:
    cases = [case for split in splits for case in data.cases(split)]
    expect_no_leak(weights, data, cases, name="W")


def test_cases_of_the_training_are_refused(data: DataSet) -> None:
    """Train and validation, whatever the card says; test and unseen pass."""
    weights = untrained(data)
    leak(data, weights, Split.TEST, Split.UNSEEN)
    for split in (Split.TRAIN, Split.VALIDATION):
        with pytest.raises(DesignError, match="is a case of the training of W"):
            leak(data, weights, split)


def test_an_object_that_was_shown_is_refused(data: DataSet) -> None:
    """The flower stands in the card; or the card names no objects at all."""
    with pytest.raises(DesignError, match=r"the object of flower_.* was shown to W"):
        leak(data, untrained(data, indenters=[*SEEN, "flower"]), Split.UNSEEN)
    with pytest.raises(DesignError, match="does not say which objects"):
        leak(data, untrained(data, indenters=[]), Split.UNSEEN)


def test_test_cases_of_another_set_are_refused(data: DataSet) -> None:
    """Another key, or none: its test cases may have been trained on; unseen objects were not."""
    for dataset in ({"key": "another"}, {}):
        weights = untrained(data, dataset=dataset)
        leak(data, weights, Split.UNSEEN)
        with pytest.raises(DesignError, match="nothing says that W was not trained on"):
            leak(data, weights, Split.TEST)


def test_several_sets_of_one_training_are_known(data: DataSet) -> None:
    """The card of a joined training lists their keys; its own key is of their content.

    A set that is not in the list is as good as unknown.
    """
    leak(data, untrained(data, dataset={"key": "joined", "keys": ["a", data.key]}), Split.TEST)
    with pytest.raises(DesignError, match="nothing says that W was not trained on"):
        leak(data, untrained(data, dataset={"key": "joined", "keys": ["a", "b"]}), Split.TEST)


def test_another_stiffness_has_the_same_split_and_another_seed_has_not(
    data: DataSet, tmp_path: Path
) -> None:
    """The card's material in the place of the set's gives the training's key, or does not."""
    weights = untrained(data)
    soft = made_up(tmp_path / "soft", young_MPa=0.0725, cases=8)
    assert soft.key != data.key
    leak(soft, weights, Split.TEST, Split.UNSEEN)
    recipe = {**soft.manifest["recipe"], "seed": 7}
    shuffled = DataSet(soft.folder, {**soft.manifest, "recipe": recipe}, soft.skin, soft.cases())
    with pytest.raises(DesignError, match="nothing says"):
        leak(shuffled, weights, Split.TEST)


def test_nothing_held_out_is_said(tmp_path: Path) -> None:
    """One case, of the training."""
    data = made_up(tmp_path, cases=1)
    assert data.cases()[0].split is Split.TRAIN
    with pytest.raises(DesignError, match="no sample of the splits test and unseen"):
        expect_held_out(data, "data")


def test_empty_ratios_are_not_numbers(data: DataSet) -> None:
    """Where the contact solver is right, no ratio to it is made."""
    rows = scored_states(data, states(data), Target.FORCE, oracle(data, Target.FORCE))
    found = compared(rows)
    assert math.isnan(found.error_ratio(Way.MPM, Way.LEARNED))
