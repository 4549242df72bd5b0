"""Tables of an evaluation as HTML."""

from __future__ import annotations

import html
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

import numpy as np

from sim.forces.network.spec import Target
from sim.forces.peaks import DISC_MM
from sim.forces.scores import Summary
from workbench.learning.evaluation import published
from workbench.learning.evaluation.evaluate import FieldResult
from workbench.learning.evaluation.scoring import Compared, Scored, Way, compared, grouped
from workbench.learning.evaluation.sources import HELD_OUT
from workbench.learning.evaluation.stiffness import StiffnessResult, Tuning

LIMITS = {Way.MPM: 0.5, Way.ZERO: 0.25}
"""Of the learned force's error over that of the other way, on unseen objects."""
FIELD_WORDS = {Target.FORCE: "force", Target.DISPLACEMENT: "displacement"}
WORDS: dict[str, str] = {Way.MPM: "contact solver"}
WAY_WORDS: dict[str, str] = {
    Tuning.TUNED: "tuned here",
    Tuning.SCALED: "untuned, times the ratio of E",
    Tuning.UNTUNED: "untuned",
    Way.LEARNED: "trained here",
    Way.MPM: "contact solver",
    Way.ZERO: "zero",
}


def grid(heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """A table with heads; numbers are right, text is escaped, None and NaN are dashes."""
    top = "".join(f"<th>{html.escape(head)}</th>" for head in heads)
    body = "".join(f"<tr>{''.join(map(_cell, row))}</tr>" for row in rows)
    return f"<div style='overflow-x:auto'><table><tr>{top}</tr>{body}</table></div>"


def _cell(value: Any) -> str:
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return "<td class='n'>–</td>"
    if isinstance(value, (int, float)):
        return f"<td class='n' style='white-space:nowrap'>{number(value)}</td>"
    return f"<td>{html.escape(str(value))}</td>"


def number(value: float) -> str:
    """Three digits; whole numbers whole."""
    return f"{value:,}" if isinstance(value, int) else f"{value:.3g}"


def summary_table(results: Iterable[FieldResult], areas_mm2: np.ndarray) -> str:
    """Each field and split: errors of the three ways, ratios, and the error over the peak."""
    heads = ("field", "split", "cases", "samples", "learned", "contact solver", "zero", "unit",
             "learned / contact solver", "learned / zero", "peak", "learned over peak [%]",
             "paper over our peak [%]")  # fmt: skip
    rows = []
    for found in results:
        for split in HELD_OUT:
            if members := found.of(split):
                numbers = _numbers(compared(members), found, areas_mm2)
                rows.append((FIELD_WORDS[found.target], split.value, *numbers))
    return grid(heads, rows)


def _numbers(one: Compared, found: FieldResult, areas_mm2: np.ndarray) -> tuple[Any, ...]:
    paper = published.over_peak(found.target, one.learned.peak, areas_mm2)
    return (
        one.cases,
        one.learned.samples,
        *(one.ways[way].mae for way in Way),
        found.target.unit,
        one.error_ratio(Way.LEARNED, Way.MPM),
        one.error_ratio(Way.LEARNED, Way.ZERO),
        one.learned.peak,
        100.0 * one.learned.over_peak,
        100.0 * paper,
    )


def axes_table(found: FieldResult) -> str:
    """Mean absolute error along X, Y and Z of the sensor, by way and split."""
    rows = []
    for split in HELD_OUT:
        if members := found.of(split):
            ways = compared(members).ways
            rows += [(split.value, WORDS.get(way, way), *ways[way].mae_xyz) for way in Way]
    unit = found.target.unit
    return grid(("split", "way", f"X [{unit}]", f"Y [{unit}]", f"Z [{unit}]"), rows)


def totals_table(found: FieldResult) -> str:
    """Errors of the total force along the axes of the press, beside the paper's."""
    heads = ["split", "way"]
    for axis, _, _ in published.TOTALS:
        heads += [f"{axis} [N]", "% of mean", "% of full scale"]
    rows: list[Sequence[Any]] = []
    for split in HELD_OUT:
        if members := found.of(split):
            for way, one in compared(members).ways.items():
                cells: list[Any] = [split.value, WORDS.get(way, way)]
                triples = zip(one.total_mae, one.total_mean, one.total_largest, strict=True)
                for error, mean, largest in triples:
                    cells += [error, _percent(error, mean), _percent(error, largest)]
                rows.append(cells)
    paper: list[Any] = ["paper", "against a real sensor"]
    for _, error, share in published.TOTALS:
        paper += [error, share, None]
    return grid(heads, [*rows, paper])


def _percent(value: float, of: float) -> float | None:
    return 100.0 * value / of if of > 0.0 else None


def indenter_table(found: FieldResult) -> str:
    """Each object: errors of the three ways, ratios, and of forces how far off their peaks are."""
    unit = found.target.unit
    heads = ("object", "split", "samples", f"learned [{unit}]", "contact solver", "zero",
             "learned / contact solver", "learned / zero",
             *(head for head, _ in _biases(found.target)))  # fmt: skip
    groups = grouped(found.samples, lambda sample: sample.case.indenter.value)
    first: Mapping[str, Scored] = {
        each.case.indenter.value: each for each in reversed(found.samples)
    }
    rows = [
        (
            name.replace("_", " "),
            first[name].case.split.value,
            one.learned.samples,
            *(one.ways[way].mae for way in Way),
            one.error_ratio(Way.LEARNED, Way.MPM),
            one.error_ratio(Way.LEARNED, Way.ZERO),
            *(100.0 * size(one.learned) for _, size in _biases(found.target)),
        )
        for name, one in sorted(groups.items(), key=lambda item: item[1].learned.mae)
    ]
    return grid(heads, rows)


def _biases(target: Target) -> list[tuple[str, Callable[[Summary], float]]]:
    """What the table of objects says of peaks: of forces only."""
    if target is not Target.FORCE:
        return []
    return [
        ("peak pressure bias [%]", lambda one: one.peak_pressure_bias),
        (f"{DISC_MM:g} mm disc force bias [%]", lambda one: one.peak_disc_bias),
    ]


def stiffness_html(
    results: Sequence[StiffnessResult], nominal: Iterable[FieldResult], nominal_MPa: float
) -> str:
    """Each stiffness and field: the ways beside each other, and the paper's worst.

    Args:
        results: Of other stiffnesses.
        nominal: Of the stiffness that the networks were trained at.
        nominal_MPa: Young's modulus there [MPa].
    """
    heads = ("field", "E [MPa]", "ratio of E", "way", "samples", "mean error", "unit",
             "over peak [%]", "total force, worst axis [N]")  # fmt: skip
    rows: list[Sequence[Any]] = []
    for found in nominal:
        ways = compared(found.samples).ways
        rows += _stiffness_rows(found.target, nominal_MPa, 1.0, ways)
    for found in results:
        rows += _stiffness_rows(found.target, found.young_MPa, found.factor, found.found.ways)
    for target, mae in published.TUNED_MAE.items():
        total = published.TUNED_TOTAL_N if target is Target.FORCE else None
        label = (FIELD_WORDS[target], None, None, "paper, worst of three, tuned", None)
        rows.append((*label, mae, target.unit, None, total))
    return grid(heads, rows)


def _stiffness_rows(
    target: Target, young_MPa: float, factor: float, ways: Mapping[str, Summary]
) -> list[Sequence[Any]]:
    force = target is Target.FORCE
    return [
        (
            FIELD_WORDS[target],
            young_MPa,
            factor,
            WAY_WORDS.get(way, way),
            one.samples,
            one.mae,
            target.unit,
            100.0 * one.over_peak,
            max(one.total_mae) if force else None,
        )
        for way, one in ways.items()
        # A displacement is not scaled: that would be the untuned one twice.
        if force or way != Tuning.SCALED
    ]
