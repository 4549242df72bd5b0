"""One evaluation: weights on a source of held-out samples, as tables."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

from sim.forces.network.spec import FIELDS, Target
from sim.forces.network.weights import NetworkWeights
from sim.forces.peaks import DISC_MM
from workbench.core.base.errors import SolveError
from workbench.core.base.monitor import Monitor, part, silent
from workbench.learning.dataset.cases import Split
from workbench.learning.evaluation.groups import by_station, depth_of, shear_of, station_of
from workbench.learning.evaluation.leaks import expect_no_leak
from workbench.learning.evaluation.scoring import (
    Scored,
    as_table,
    compared,
    field_target,
    grouped,
    learned_by,
    predictor_for,
    scored_states,
)
from workbench.learning.evaluation.sources import Source, expect_held_out


@dataclass(frozen=True, kw_only=True, slots=True)
class Named:
    """Weights and the name of their file."""

    name: str
    weights: NetworkWeights


@dataclass(frozen=True, kw_only=True, slots=True)
class FieldResult:
    """All samples of one field."""

    target: Target
    weights: str
    """Name of the file."""
    samples: tuple[Scored, ...]
    notes: tuple[str, ...] = field(default=())
    """What the reader must know beside the numbers."""

    def of(self, *splits: Split) -> list[Scored]:
        """Samples of some splits."""
        return [sample for sample in self.samples if sample.case.split in splits]


def evaluate_field(
    source: Source, named: Named, *, name: str, monitor: Monitor = silent
) -> FieldResult:
    """Score weights on everything held out of a source.

    Args:
        source: Of the samples.
        named: The weights.
        name: Of the source, for messages.
        monitor: Told after each sample.

    Raises:
        DesignError: If nothing is held out, or a case was trained on.
        StoreError: If a sample is damaged.
        SolveError: If a prediction is not finite.
    """
    target = field_target(named.weights)
    chosen = expect_held_out(source, name)
    cases = {case.id: case for case, _ in chosen}
    expect_no_leak(named.weights, source, cases.values(), name=named.name)
    predictor = predictor_for(named.weights, source)
    learned = learned_by(named.weights, predictor)
    samples = scored_states(source, chosen, target, learned, monitor=monitor)
    if not samples:
        raise SolveError(
            f"no held-out sample of {name} was settled by both solvers",
            hint="make the data set again with smaller depths",
            at=name,
        )
    notes = _notes(named.weights, source, predictor.notes)
    if len(samples) < len(chosen):
        notes += (f"{len(chosen) - len(samples)} samples that a solver did not settle: left out",)
    return FieldResult(target=target, weights=named.name, samples=tuple(samples), notes=notes)


def evaluate_all(
    source: Source, weights: Sequence[Named], *, name: str, monitor: Monitor = silent
) -> dict[Target, FieldResult]:
    """Score several weights, by target; the last of a target counts."""
    found = {}
    for number, named in enumerate(weights):
        step = part(monitor, number / len(weights), (number + 1) / len(weights))
        one = evaluate_field(source, named, name=name, monitor=step)
        found[one.target] = one
    return {target: found[target] for target in FIELDS if target in found}


def tables(found: FieldResult) -> dict[str, Any]:
    """All tables of a field for JSON: presses and shears apart wherever places and ways count."""
    pressed = [sample for sample in found.samples if not sample.sheared]
    sheared = [sample for sample in found.samples if sample.sheared]
    return {
        "unit": found.target.unit,
        "weights": found.weights,
        "notes": list(found.notes),
        "splits": _tables(found.samples, lambda sample: sample.case.split.value),
        "all": as_table(compared(found.samples)),
        "motions": _tables(found.samples, lambda sample: "shear" if sample.sheared else "press"),
        "indenters": _tables(found.samples, lambda sample: sample.case.indenter.value),
        "press_stations": _tables(by_station(pressed), station_of),
        "shear_stations": _tables(by_station(sheared), station_of),
        "press_depths_mm": _tables(sorted(pressed, key=lambda sample: sample.depth_mm), depth_of),
        "shear_ways_mm": _tables(sorted(sheared, key=lambda sample: sample.shear_mm), shear_of),
        "peaks": list(_peaks(found.samples)),
    }


def _peaks(samples: Iterable[Scored]) -> Iterator[dict[str, Any]]:
    """A row for each sample of forces: largest pressure and disc force, of all ways and `fem`."""
    for sample in samples:
        row: dict[str, Any] = {
            "case": sample.case.id,
            "frame": sample.frame,
            "indenter": sample.case.indenter.value,
            "split": sample.case.split.value,
            "disc_mm": DISC_MM,
        }
        named = {str(way): score.found_peaks for way, score in sample.scores.items()}
        named["fem"] = next(score.true_peaks for score in sample.scores.values())
        known = {name: peaks for name, peaks in named.items() if peaks is not None}
        if known:
            yield row | {name: dataclasses.asdict(peaks) for name, peaks in known.items()}


def _tables(samples: Iterable[Scored], name: Callable[[Scored], str]) -> dict[str, Any]:
    return {group: as_table(one) for group, one in grouped(samples, name).items()}


def _notes(weights: NetworkWeights, source: Source, notes: tuple[str, ...]) -> tuple[str, ...]:
    from sim.forces.network.voxels import spacing_mm

    found = list(notes)
    spacing = spacing_mm(source.skin.points_mm, source.skin.faces)
    if abs(spacing / weights.spacing_mm - 1.0) > 0.02:
        found.append(
            f"trained on points {weights.spacing_mm:.2f} mm apart, scored on {spacing:.2f} mm: "
            "nodal forces grow with the area of a point"
        )
    return tuple(found)
