"""Scores of a network on held-out samples, each beside those of two predictors that need none.

These are predicting nothing, and the contact solver. All is predicted in single precision.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from sim.forces.network.inputs import given_field
from sim.forces.network.spec import FIELDS, Target
from sim.forces.network.weights import NetworkWeights
from sim.forces.peaks import Triangles, peaks
from sim.forces.scores import Score, Summary, press_frame, ratio, score, summary
from workbench.core.base.errors import DesignError, StoreError
from workbench.core.base.monitor import Monitor, silent
from workbench.learning.dataset.cases import Case
from workbench.learning.dataset.sample import Sample, Solved
from workbench.learning.evaluation.sources import Source

if TYPE_CHECKING:
    from sim.forces.network.steady import SteadyPredictor


class Way(StrEnum):
    """Who says what the field is."""

    LEARNED = "learned"
    MPM = "mpm"
    """The contact solver's own field, as it is."""
    ZERO = "zero"


@dataclass(frozen=True, kw_only=True, slots=True)
class Scored:
    """One sample."""

    case: Case
    frame: int
    scores: Mapping[str, Score]
    """By `Way`, or by another name where more ways are compared."""

    @property
    def sheared(self) -> bool:
        """Whether it is a frame of a shear, else of a press."""
        return self.frame >= self.case.press_frames

    @property
    def depth_mm(self) -> float:
        """Depth from first touch [mm]."""
        return self.case.depth_at(self.frame)

    @property
    def shear_mm(self) -> float:
        """Way aside [mm], along U or V, the larger."""
        return max(map(abs, self.case.shear_at(self.frame)))


@dataclass(frozen=True, kw_only=True, slots=True)
class Compared:
    """The ways beside each other over many samples."""

    cases: int
    ways: Mapping[str, Summary]

    @property
    def learned(self) -> Summary:
        """Of the network."""
        return self.ways[Way.LEARNED]

    def error_ratio(self, way: str, over: str) -> float:
        """Mean absolute error of one way over that of another; NaN where that makes none."""
        return ratio(self.ways[way].mae, self.ways[over].mae)


Learned = Callable[[Solved], np.ndarray]
"""From the contact solver's answer to a field (V, 3)."""


def field_target(weights: NetworkWeights) -> Target:
    """The target of weights that can be scored.

    Raises:
        DesignError: If they predict stress, which the contact solver has no raw answer for.
    """
    if weights.target not in FIELDS:
        raise DesignError(
            f"weights for {weights.target} cannot be evaluated",
            hint=f"give weights for {' or '.join(FIELDS)}",
            at="--weights",
        )
    return weights.target


def predictor_for(weights: NetworkWeights, source: Source) -> SteadyPredictor:
    """The network on the skin of a data set, in single precision, on the device there is."""
    from sim.forces.network.steady import steady_predictor
    from workbench.pipeline.devices import torch_device

    skin = source.skin
    return steady_predictor(weights, skin.points_mm, skin.faces, device=torch_device())


def learned_by(
    weights: NetworkWeights, predictor: SteadyPredictor, *, factor: float = 1.0
) -> Learned:
    """What a network says of an answer of the contact solver.

    Args:
        weights: Of the network.
        predictor: The network on the skin of the answers.
        factor: Young's modulus of the answers over that of the training.
    """

    def learned(mpm: Solved) -> np.ndarray:
        force_N, displacement_mm = mpm.contact_force_N, mpm.displacement_mm
        return predictor.predict(given_field(weights, displacement_mm, force_N, factor=factor))

    return learned


def scored_states(
    source: Source,
    chosen: Sequence[tuple[Case, int]],
    target: Target,
    learned: Learned,
    *,
    monitor: Monitor = silent,
) -> list[Scored]:
    """Score states one after the other; one that a solver did not settle is no truth: left out.

    Args:
        source: Where the samples are.
        chosen: Cases and frames.
        target: Which field.
        learned: What is scored.
        monitor: Told after each sample; may raise `Cancelled`.

    Raises:
        StoreError: If a sample is damaged, or lacks one of the solvers.
        SolveError: If a prediction is not finite.
    """
    found = []
    for number, (case, frame) in enumerate(chosen):
        monitor(number / len(chosen), f"{case.id}, frame {frame + 1}")
        sample = source.sample(case, frame)
        if all(solved.converged for solved in both(sample)):
            scores = scores_of(sample, target, fields_of(sample, target, learned), source.skin)
            found.append(Scored(case=case, frame=frame, scores=scores))
    return found


def both(sample: Sample) -> tuple[Solved, Solved]:
    """The contact solver's and the finite elements' answer.

    Raises:
        StoreError: If it lacks one of them.
    """
    if sample.mpm is None or sample.fem is None:
        raise StoreError(
            f"frame {sample.frame + 1} of {sample.case} has no answer of "
            f"{'the contact solver' if sample.mpm is None else 'the finite elements'}",
            hint="make the data set with --solver both",
            at=sample.case,
        )
    return sample.mpm, sample.fem


def fields_of(sample: Sample, target: Target, learned: Learned) -> dict[str, np.ndarray]:
    """What the three ways say, each (V, 3)."""
    mpm, _ = both(sample)
    raw = getattr(mpm, FIELDS[target])
    return {
        Way.LEARNED: learned(mpm),
        Way.MPM: raw,
        Way.ZERO: np.zeros_like(raw),
    }


def scores_of(
    sample: Sample, target: Target, fields: Mapping[str, np.ndarray], skin: Triangles
) -> dict[str, Score]:
    """Fields beside that of the finite elements; pressures are along these's normals."""
    _, fem = both(sample)
    frame = press_frame(sample.normal, sample.tangent_u)
    truth = getattr(fem, FIELDS[target])
    if target is not Target.FORCE:
        return {way: score(field, truth, frame) for way, field in fields.items()}
    true = fem.peaks(skin)
    return {
        way: score(field, truth, frame, peaks=(peaks(skin, field, fem.displacement_mm), true))
        for way, field in fields.items()
    }


def compared(samples: Iterable[Scored]) -> Compared:
    """Take samples together, way by way; at least one."""
    samples = list(samples)
    ways = {way: summary([sample.scores[way] for sample in samples]) for way in samples[0].scores}
    return Compared(cases=len({sample.case.id for sample in samples}), ways=ways)


def grouped(samples: Iterable[Scored], name: Callable[[Scored], str]) -> dict[str, Compared]:
    """Samples taken together by a name, in the order in which names first come."""
    groups: dict[str, list[Scored]] = {}
    for sample in samples:
        groups.setdefault(name(sample), []).append(sample)
    return {group: compared(members) for group, members in groups.items()}


def as_table(found: Compared) -> dict[str, object]:
    """Plain numbers for JSON, with the ratios that limits are set on."""
    return {
        "cases": found.cases,
        "samples": found.learned.samples,
        **{str(way): dataclasses.asdict(one) for way, one in found.ways.items()},
        "learned_over_mpm": found.error_ratio(Way.LEARNED, Way.MPM),
        "learned_over_zero": found.error_ratio(Way.LEARNED, Way.ZERO),
        "mpm_over_zero": found.error_ratio(Way.MPM, Way.ZERO),
    }
