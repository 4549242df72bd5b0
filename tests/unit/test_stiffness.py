"""Another stiffness: the null is exact where the truth is in proportion to E, and says so."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from sim.forces.network.spec import FIELDS, Target
from sim.forces.network.weights import NetworkWeights
from tests.synthetic_presses import made_up
from tests.unit.test_evaluation import untrained
from workbench.core.base.errors import DesignError
from workbench.learning.dataset.folder import DataSet
from workbench.learning.evaluation import stiffness
from workbench.learning.evaluation.evaluate import Named
from workbench.learning.evaluation.scoring import Way
from workbench.learning.evaluation.sources import Source, states
from workbench.learning.evaluation.stiffness import Tuning, evaluate_stiffness, stiffness_table

SOFT_MPa = 0.0725


@pytest.fixture(scope="module")
def sets(tmp_path_factory: pytest.TempPathFactory) -> tuple[DataSet, DataSet]:
    """The same cases at the nominal stiffness and at half of it; made-up forces are linear in E."""
    folder = tmp_path_factory.mktemp("pads")
    return made_up(folder / "base", cases=12), made_up(folder / "soft", young_MPa=0.0725, cases=12)


class Oracle:
    """Predicts what finite elements of the set that its weights were trained on say."""

    def __init__(self, weights: NetworkWeights, known: DataSet) -> None:
        self.known = {}
        for case, frame in states(known):
            sample = known.sample(case, frame)
            assert sample.mpm is not None and sample.fem is not None
            field = getattr(sample.fem, FIELDS[weights.target])
            self.known[sample.mpm.displacement_mm.tobytes()] = field

    def predict(self, displacement_mm: np.ndarray) -> np.ndarray:
        return self.known[displacement_mm.tobytes()]


@pytest.fixture
def oracles(sets: tuple[DataSet, DataSet], monkeypatch: pytest.MonkeyPatch) -> None:
    """Every network is an oracle of its training set."""

    def predictor_for(weights: NetworkWeights, source: Source) -> Any:
        nominal = weights.card["young_MPa"] == 0.145
        return Oracle(weights, sets[0] if nominal else sets[1])

    monkeypatch.setattr(stiffness, "predictor_for", predictor_for)


def named(data: DataSet, target: Target = Target.FORCE) -> Named:
    weights = untrained(data, target)
    return Named(name=f"{weights.card['young_MPa']}-{target}", weights=weights)


@pytest.mark.usefixtures("oracles")
def test_the_scaled_force_is_exact_and_the_untuned_one_is_not(
    sets: tuple[DataSet, DataSet],
) -> None:
    """At half of E: scaled 0, tuned 0, untuned as wrong as zero (2 F - F against F)."""
    base, soft = sets
    (found,) = evaluate_stiffness(soft, [named(base), named(soft)], base, name="soft")
    ways = found.found.ways
    assert found.factor == pytest.approx(0.5)
    assert ways[Tuning.TUNED].mae == 0.0
    assert ways[Tuning.SCALED].mae <= 1e-6 * ways[Way.ZERO].mae
    assert ways[Tuning.UNTUNED].mae == pytest.approx(ways[Way.ZERO].mae, rel=1e-5)
    # Float32 forces of two sets: proportional to a rounding.
    assert found.common == len(states(soft)) and found.truth_off < 1e-6
    table = stiffness_table(found)
    assert table["ways"]["scaled"]["mae"] == ways[Tuning.SCALED].mae


@pytest.mark.usefixtures("oracles")
def test_displacements_are_not_scaled(sets: tuple[DataSet, DataSet]) -> None:
    """Under prescribed displacements they do not depend on E."""
    base, soft = sets
    weights = [named(base, Target.DISPLACEMENT)]
    (found,) = evaluate_stiffness(soft, weights, base, name="soft")
    assert Tuning.TUNED not in found.found.ways
    assert found.found.ways[Tuning.SCALED].mae == found.found.ways[Tuning.UNTUNED].mae == 0.0
    assert found.truth_off == 0.0


@pytest.mark.usefixtures("oracles")
def test_without_the_nominal_set_the_truth_is_not_compared(
    sets: tuple[DataSet, DataSet],
) -> None:
    """The fields are scored all the same."""
    base, soft = sets
    (found,) = evaluate_stiffness(soft, [named(base)], None, name="soft")
    assert found.common == 0 and math.isnan(found.truth_off)
    assert found.found.ways[Tuning.SCALED].mae <= 1e-6 * found.found.ways[Way.ZERO].mae


def test_weights_of_one_stiffness_alone_are_refused(sets: tuple[DataSet, DataSet]) -> None:
    """Tuned weights have nothing to stand beside; a card without E says nothing."""
    base, soft = sets
    with pytest.raises(DesignError, match="no weights were trained at another stiffness"):
        evaluate_stiffness(soft, [named(soft)], base, name="soft")
    unknown = Named(name="w", weights=untrained(base, young_MPa=None))
    with pytest.raises(DesignError, match="does not say at which Young's modulus"):
        evaluate_stiffness(soft, [unknown], base, name="soft")


def test_a_set_of_another_stiffness_has_the_same_cases(tmp_path: Path) -> None:
    """`--young` changes the key and the modulus, neither the cases nor their split."""
    import argparse

    from workbench.cli.groups.dataset_make import chosen_recipe
    from workbench.learning.dataset.cases import cases_of
    from workbench.project.project import Project

    def recipe(young: float | None):
        names = ("cases", "seed", "solver", "draft", "no_images")
        options = dict.fromkeys(names) | {"recipe": "small", "young": young}
        options |= {"turn_deg": None, "set": []}
        return chosen_recipe(argparse.Namespace(**options), Project(str(tmp_path)))

    nominal, soft = recipe(None), recipe(SOFT_MPa)
    assert soft.design.material.young_MPa == SOFT_MPa
    assert nominal.key != soft.key
    assert cases_of(nominal) == cases_of(soft)
    with pytest.raises(DesignError, match="modulus -1 MPa"):
        recipe(-1.0)
