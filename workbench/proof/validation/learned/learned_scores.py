"""The shipped networks on presses that no training looked at: membrane by membrane, and together.

Scores come from the held-out sets that ship with the weights, or from a data set that is named
(`workbench validate forces --data DIR`). Without weights, or without samples to score them on, the
rows fail and say so. Every error stands beside a null: of a ratio to the contact solver what
predicting nothing has as that ratio, of all others what the contact solver has.
"""

from __future__ import annotations

import functools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from sim.forces.network.spec import Target
from sim.forces.network.weights import load_weights
from sim.forces.scores import ratio
from workbench.core.base.errors import StoreError, WorkbenchError
from workbench.learning.dataset.cases import Split
from workbench.learning.evaluation import published
from workbench.learning.evaluation.evaluate import Named, evaluate_field
from workbench.learning.evaluation.scoring import Compared, Scored, Way, compared, grouped
from workbench.learning.evaluation.sources import Source, open_source
from workbench.pipeline import shipped
from workbench.proof.row import Row, bounded, failed, stated

WORDS = {Target.FORCE: "force", Target.DISPLACEMENT: "deformation"}
LIMITS = {
    Target.FORCE: {Way.MPM: 1.0, Way.ZERO: 0.12},
    Target.DISPLACEMENT: {Way.MPM: 1.0},
}
"""Of the learned error over that of the other way. One that is worse than the contact solver, whose
answer the network was given, is of no use."""
NULLS = {Way.MPM: Way.ZERO, Way.ZERO: Way.MPM}
SPLITS = (Split.UNSEEN, Split.TEST)
TOGETHER = {
    "learned_force_worst_object": 1.0,
    "learned_force_sheared": 0.14,
    "learned_peak_bias": 0.10,
    "learned_total_ratio": 0.02,
}
"""Limits of the rows about all membranes together."""
PLACES = ("X, shear along U", "Y, shear along V", "Z, normal")


@dataclass(frozen=True, kw_only=True, slots=True)
class Scores:
    """Samples of one membrane, scored."""

    membrane: str
    areas_mm2: np.ndarray
    """Of its vertices, shape (V,)."""
    samples: tuple[Scored, ...]

    def of(self, split: Split) -> list[Scored]:
        """Samples of one split."""
        return [sample for sample in self.samples if sample.case.split is split]


def score_rows(target: Target, data: Path | None = None) -> list[Row]:
    """All rows of one field; failed ones where it could not be scored.

    Args:
        target: Which field.
        data: A data set, or a held-out set; None: those that ship.
    """
    try:
        weights, found = evaluated(target, data)
    except WorkbenchError as error:
        why = "; ".join(filter(None, (error.message, error.hint)))
        return [failed(name, words, unit=unit, why=why) for name, words, unit in _names(target)]
    rows = []
    for split in SPLITS:
        pressed = [one for one in found if one.of(split)]
        if not pressed:
            why = f"no sample of the split {split}"
            rows += [
                failed(name, words, unit=unit, why=why)
                for name, words, unit in _names(target)
                if name.endswith(f"_{split}")
            ]
        for one in pressed:
            rows += _membrane_rows(weights, target, one, split)
        if target is Target.FORCE and pressed:
            rows += _together_rows(weights, split, pressed)
    return rows


def evaluated(target: Target, data: Path | None) -> tuple[str, list[Scores]]:
    """Name of the shipped weights of a target, and their scores on everything that was held out.

    Raises:
        StoreError: If weights or samples are missing or damaged.
        DesignError: If a case was trained on.
        SolveError: If a prediction is not finite.
    """
    path = shipped.shipped_weights(target)
    named = Named(name=path.name, weights=load_weights(path))
    found = []
    for membrane, places in held_out_places(data).items():
        sources = [(_opened(place), place) for place in places]
        samples = [
            sample
            for source, place in sources
            for sample in evaluate_field(source, named, name=str(place)).samples
        ]
        areas_mm2 = np.asarray(sources[0][0].skin.areas_mm2)
        found.append(Scores(membrane=membrane, areas_mm2=areas_mm2, samples=tuple(samples)))
    return path.name, found


def held_out_places(data: Path | None) -> dict[str, list[Path]]:
    """Where the samples are, by membrane.

    Raises:
        StoreError: If none ship and none were named.
    """
    if data is not None:
        return {data.name: [data]}
    found = shipped.held_out_sets()
    if not found:
        raise StoreError(
            "no held-out set comes with this version",
            hint="make one with workbench evaluate DATA --pack FILE, or name a set with --data",
            at=str(shipped.FOLDER),
        )
    return found


@functools.lru_cache(maxsize=12)
def _opened(place: Path) -> Source:
    return open_source(place)


def _names(target: Target) -> Iterator[tuple[str, str, str]]:
    """Name, case and unit of each row that scores make."""
    words = WORDS[target]
    for split in SPLITS:
        for way in NULLS:
            yield f"learned_{words}_ratio_{way}_{split}", "shipped weights", "1"
        yield f"learned_{words}_over_peak_{split}", "shipped weights", "1"
        if target is Target.FORCE:
            for name in TOGETHER:
                yield f"{name}_{split}", "shipped weights", "1"
            for axis in PLACES:
                yield f"learned_total_force_{split}", axis, target.unit


def _said(weights: str, one: Compared, cases: int, split: Split) -> str:
    return f"{weights} on {one.learned.samples} samples of {cases} {split} cases"


def _membrane_rows(weights: str, target: Target, scores: Scores, split: Split) -> Iterator[Row]:
    words, one = WORDS[target], compared(scores.of(split))
    case = f"{scores.membrane}: {_said(weights, one, one.cases, split)}"
    for way, null in NULLS.items():
        name = f"learned_{words}_ratio_{way}_{split}"
        text = f"{case}; learned error over that of {way}; null: {null} over {way}"
        limit = LIMITS[target].get(way)
        value, other = one.error_ratio(Way.LEARNED, way), one.error_ratio(null, way)
        if limit is None:
            yield stated(name, text, value, unit="1", null=other)
        else:
            yield bounded(name, text, value, unit="1", limit=limit, null=other)
    yield stated(
        f"learned_{words}_over_peak_{split}",
        f"{case}; mean absolute error {one.learned.mae:.3g} {target.unit} over the peak "
        f"{one.learned.peak:.3g} {target.unit}; reference: the paper's "
        f"{published.MAE[target]:.3g} {target.unit} carried to this mesh, over our peak",
        one.learned.over_peak,
        unit="1",
        reference=published.over_peak(target, one.learned.peak, scores.areas_mm2),
        null=one.ways[Way.ZERO].over_peak,
    )


def _together_rows(weights: str, split: Split, pressed: Sequence[Scores]) -> Iterator[Row]:
    samples = [sample for one in pressed for sample in one.of(split)]
    one = compared(samples)
    # Membranes have cases of the same name.
    cases = sum(compared(each.of(split)).cases for each in pressed)
    case = f"all membranes: {_said(weights, one, cases, split)}"
    objects = grouped(samples, lambda sample: sample.case.indenter.value)
    worst = max(objects, key=lambda name: objects[name].error_ratio(Way.LEARNED, Way.MPM))
    most = max(objects, key=lambda name: abs(objects[name].learned.peak_pressure_bias))
    sheared = [sample for sample in samples if sample.sheared]
    told = {
        "learned_force_worst_object": (
            f"{worst}, of {len(objects)} objects the worst: learned error over that of mpm; null: "
            "zero over mpm",
            objects[worst].error_ratio(Way.LEARNED, Way.MPM),
            objects[worst].error_ratio(Way.ZERO, Way.MPM),
        ),
        "learned_peak_bias": (
            f"{most}, of {len(objects)} objects the worst: size of the mean of largest pressures "
            "over the true ones, less 1; null: mpm",
            abs(objects[most].learned.peak_pressure_bias),
            abs(objects[most].ways[Way.MPM].peak_pressure_bias),
        ),
        "learned_total_ratio": (
            "mean error of the total force over its mean size; null: mpm",
            _total_ratio(samples, Way.LEARNED),
            _total_ratio(samples, Way.MPM),
        ),
    }
    if sheared:
        aside = compared(sheared)
        told["learned_force_sheared"] = (
            f"the {len(sheared)} sheared ones: learned error over that of zero; null: mpm",
            aside.error_ratio(Way.LEARNED, Way.ZERO),
            aside.error_ratio(Way.MPM, Way.ZERO),
        )
    for name, limit in TOGETHER.items():
        if name not in told:
            yield failed(f"{name}_{split}", case, unit="1", why="no sheared sample")
            continue
        words, value, null = told[name]
        text = f"{case}; {words}"
        yield bounded(f"{name}_{split}", text, value, unit="1", limit=limit, null=null)
    yield from _total_rows(f"learned_total_force_{split}", case, one)


def _total_ratio(samples: Sequence[Scored], way: Way) -> float:
    """Mean length of the error of the total force over the mean length of the true one."""
    scores = [sample.scores[way] for sample in samples]
    off_N = sum(float(np.linalg.norm(one.found_total - one.true_total)) for one in scores)
    return ratio(off_N, sum(float(np.linalg.norm(one.true_total)) for one in scores))


def _total_rows(name: str, case: str, one: Compared) -> Iterator[Row]:
    learned, zero = one.learned, one.ways[Way.ZERO]
    for axis, words in enumerate(PLACES):
        mean, largest = learned.total_mean[axis], learned.total_largest[axis]
        share = f"mean size {mean:.3g} N, largest {largest:.3g} N" if mean else "none at all"
        yield stated(
            name,
            f"{words}: error of the sum over all points ({share}); reference: the paper's against "
            f"a real sensor; {case}",
            learned.total_mae[axis],
            unit="N",
            reference=published.TOTALS[axis][1],
            null=zero.total_mae[axis],
        )
