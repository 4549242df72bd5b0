"""Another stiffness (Fig. 8): a network tuned for it, beside what needs no training at all.

Under prescribed displacements of a rigid object, equilibrium, contact and Coulomb friction hold for
the same displacements whatever E is, with all forces in proportion to it, as long as E is the only
modulus. So the null of tuning is the untuned network's force times the ratio of E, and the untuned
displacement as it is. Where the data set of the trained stiffness is at hand too, the finite
elements themselves are scaled and compared: that says how exact the null can be.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any

import numpy as np

from sim.forces.network.spec import FIELDS, Target
from sim.forces.scores import ratio
from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor, silent
from workbench.learning.dataset.cases import Case
from workbench.learning.evaluation.evaluate import Named
from workbench.learning.evaluation.leaks import expect_no_leak
from workbench.learning.evaluation.scoring import (
    Compared,
    Learned,
    Scored,
    Way,
    both,
    compared,
    field_target,
    learned_by,
    predictor_for,
    scores_of,
)
from workbench.learning.evaluation.sources import Source, expect_held_out, states, young_MPa

SAME = 1e-3
"""Relative difference below which two moduli are the same."""


class Tuning(StrEnum):
    """Ways to a field at another stiffness, besides those of `Way`."""

    TUNED = "tuned"
    """The network tuned at this stiffness."""
    SCALED = "scaled"
    """The untuned network; forces times the ratio of E."""
    UNTUNED = "untuned"
    """The untuned network as it is."""


@dataclass(frozen=True, kw_only=True, slots=True)
class StiffnessResult:
    """One field at one stiffness."""

    target: Target
    young_MPa: float
    trained_MPa: float
    """Of the untuned network."""
    found: Compared
    """By `Tuning` and `Way`; `TUNED` only where such weights were given."""
    truth_off: float
    """Mean |finite elements here - ratio x finite elements there| over mean |here|, on the samples
    that both sets hold; NaN where there are none."""
    common: int
    """Samples that both hold."""

    @property
    def factor(self) -> float:
        """Ratio of E."""
        return self.young_MPa / self.trained_MPa


def same_modulus(one: float, other: float) -> bool:
    """Whether two moduli are the same but for rounding."""
    return abs(one - other) <= SAME * max(abs(one), abs(other))


def trained_MPa(named: Named) -> float:
    """Young's modulus that weights were trained at [MPa].

    Raises:
        DesignError: If their card does not say.
    """
    value = named.weights.card.get("young_MPa")
    if not isinstance(value, (int, float)) or not value > 0.0:
        raise DesignError(
            f"the data card of {named.name} does not say at which Young's modulus it was trained",
            hint="train the weights again with this version",
            at="--weights",
        )
    return float(value)


def evaluate_stiffness(
    source: Source,
    weights: Sequence[Named],
    base: Source | None,
    *,
    name: str,
    monitor: Monitor = silent,
) -> list[StiffnessResult]:
    """Compare the ways to the fields of a set of another stiffness, target by target.

    Args:
        source: The set of the other stiffness.
        weights: Those trained elsewhere, and those tuned here, told apart by their cards.
        base: The set that the untuned ones were trained on, if it is at hand.
        name: Of the source, for messages.
        monitor: Told after each sample.

    Raises:
        DesignError: If no weights are of another stiffness, or a case was trained on.
    """
    here = young_MPa(source)
    tuned = {field_target(w.weights): w for w in weights if same_modulus(trained_MPa(w), here)}
    others = [w for w in reversed(weights) if not same_modulus(trained_MPa(w), here)]
    untuned = {field_target(w.weights): w for w in others}
    if not untuned:
        raise DesignError(
            f"no weights were trained at another stiffness than the {here:g} MPa of {name}",
            hint="give the weights of the nominal stiffness too",
            at="--weights",
        )
    return [
        _one(source, untuned[target], tuned.get(target), base, name, monitor)
        for target in FIELDS
        if target in untuned
    ]


def _one(
    source: Source,
    untuned: Named,
    tuned: Named | None,
    base: Source | None,
    name: str,
    monitor: Monitor,
) -> StiffnessResult:
    target = field_target(untuned.weights)
    chosen = expect_held_out(source, name)
    cases = {case.id: case for case, _ in chosen}
    factor = young_MPa(source) / trained_MPa(untuned)
    networks: dict[Tuning, Learned] = {}
    for named in [untuned] if tuned is None else [untuned, tuned]:
        expect_no_leak(named.weights, source, cases.values(), name=named.name)
        predictor = predictor_for(named.weights, source)
        if named is tuned:
            networks[Tuning.TUNED] = learned_by(named.weights, predictor)
        else:
            networks[Tuning.SCALED] = learned_by(named.weights, predictor, factor=factor)
            networks[Tuning.UNTUNED] = learned_by(named.weights, predictor)
    rows = []
    for number, (case, frame) in enumerate(chosen):
        monitor(number / len(chosen), f"{case.id}, frame {frame + 1}")
        sample = source.sample(case, frame)
        if not all(solved.converged for solved in both(sample)):
            continue
        mpm, _ = both(sample)
        raw = getattr(mpm, FIELDS[target])
        fields: dict[str, np.ndarray] = {
            **{way: networks[way](mpm) for way in Tuning if way in networks},
            Way.MPM: raw,
            Way.ZERO: np.zeros_like(raw),
        }
        if target is Target.FORCE:
            fields[Tuning.SCALED] = fields[Tuning.SCALED] * np.float32(factor)
        scores = scores_of(sample, target, fields, source.skin)
        rows.append(Scored(case=case, frame=frame, scores=scores))
    off, common = _truth_off(source, base, target)
    return StiffnessResult(
        target=target,
        young_MPa=young_MPa(source),
        trained_MPa=trained_MPa(untuned),
        found=compared(rows),
        truth_off=off,
        common=common,
    )


def _truth_off(source: Source, base: Source | None, target: Target) -> tuple[float, int]:
    """How far the finite elements are from being in proportion to E, and on how many samples."""
    if base is None or not np.array_equal(base.skin.points_mm, source.skin.points_mm):
        return float("nan"), 0
    factor = young_MPa(source) / young_MPa(base) if target is Target.FORCE else 1.0
    there: Mapping[tuple[str, int], Case] = {(c.id, frame): c for c, frame in states(base)}
    away = size = 0.0
    common = [(case, frame) for case, frame in states(source) if (case.id, frame) in there]
    for case, frame in common:
        _, ours = both(source.sample(case, frame))
        _, theirs = both(base.sample(there[case.id, frame], frame))
        truth = getattr(ours, FIELDS[target]).astype(np.float64)
        away += float(np.abs(truth - factor * getattr(theirs, FIELDS[target])).mean())
        size += float(np.abs(truth).mean())
    return ratio(away, size), len(common)


def stiffness_table(found: StiffnessResult) -> dict[str, Any]:
    """Plain numbers for JSON."""
    return {
        "target": found.target.value,
        "unit": found.target.unit,
        "young_MPa": found.young_MPa,
        "trained_MPa": found.trained_MPa,
        "factor": found.factor,
        "cases": found.found.cases,
        "samples": next(iter(found.found.ways.values())).samples,
        "ways": {str(way): dataclasses.asdict(one) for way, one in found.found.ways.items()},
        "truth_off_proportion": found.truth_off,
        "truth_samples": found.common,
    }
