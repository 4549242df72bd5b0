"""Learned forces: the shipped networks on what they never saw, and the network itself.

Scores come from the held-out set that ships with the weights, or from a data set that is named
(`workbench validate forces --data DIR`). Without weights, or without samples to score them on, the
rows fail and say so. Every error stands beside a null: of a ratio to the contact solver what
predicting nothing has as that ratio, of a ratio to nothing what the contact solver has.

Frame rates are measured on the spot; the case says how many processes wanted to run meanwhile.
Those of a GPU come from a record (`workbench bench efficiency --record`).
"""

from __future__ import annotations

import functools
from collections.abc import Callable, Iterator
from pathlib import Path

from sim.forces.network.spec import Target
from sim.forces.network.weights import load_weights
from workbench.core.base.errors import StoreError, WorkbenchError
from workbench.learning.dataset.cases import Split
from workbench.learning.evaluation import published
from workbench.learning.evaluation.evaluate import FieldResult, Named, evaluate_field
from workbench.learning.evaluation.scoring import Compared, Way, compared
from workbench.learning.evaluation.sources import Source, open_source
from workbench.pipeline import shipped
from workbench.pipeline.advice import ERRORS
from workbench.proof.row import Row, bounded, failed, stated

HELD_OUT = "heldout.npz"
"""In the folder of the shipped weights."""
WORDS = {Target.FORCE: "force", Target.DISPLACEMENT: "deformation"}
LIMITS = {
    Target.FORCE: {Way.MPM: 0.5, Way.ZERO: 0.25},
    Target.DISPLACEMENT: {Way.MPM: 1.0},
}
"""Of the learned error over that of the other way. A displacement that is worse than the one that
the network was given is of no use."""
NULLS = {Way.MPM: Way.ZERO, Way.ZERO: Way.MPM}
SPLITS = (Split.UNSEEN, Split.TEST)
PLACES = ("X, shear along U", "Y, shear along V", "Z, normal")
CONVOLUTION_POINTS = 1000
SPARSE_LIMITS = {"float32": 1e-6, "float64": 1e-12}


def rows(data: Path | None = None) -> list[Row]:
    """All rows of learned forces.

    Args:
        data: A data set, or a held-out set; None: the one that ships.
    """
    from workbench.proof.validation.learned import (
        learned_precision,
        learned_speed,
        learned_stiffness,
    )

    found: list[Row] = []
    for target in WORDS:
        found += score_rows(target, data)
    found += learned_stiffness.rows()
    found.append(advice_row())
    found += sparse_rows()
    found += learned_precision.rows(shipped.FOLDER / HELD_OUT if data is None else data)
    return [*found, *learned_speed.rows()]


def held_out_place(data: Path | None) -> Path:
    """Where the samples are.

    Raises:
        StoreError: If none ship and none were named.
    """
    place = shipped.FOLDER / HELD_OUT if data is None else data
    if data is None and not place.exists():
        raise StoreError(
            "no held-out set comes with this version",
            hint="make one with workbench evaluate DATA --pack FILE, or name a set with --data",
            at=str(place),
        )
    return place


@functools.lru_cache(maxsize=2)
def _opened(place: Path) -> Source:
    return open_source(place)


def evaluated(target: Target, data: Path | None) -> tuple[Source, FieldResult]:
    """The shipped weights of a target on everything that was held out.

    Raises:
        StoreError: If weights or samples are missing or damaged.
        DesignError: If a case was trained on.
        SolveError: If a prediction is not finite.
    """
    path = shipped.shipped_weights(target)
    source = _opened(held_out_place(data))
    named = Named(name=path.name, weights=load_weights(path))
    return source, evaluate_field(source, named, name=str(held_out_place(data)))


def score_rows(target: Target, data: Path | None = None) -> list[Row]:
    """All rows of one field; failed ones where it could not be scored."""
    try:
        source, found = evaluated(target, data)
    except WorkbenchError as error:
        why = "; ".join(filter(None, (error.message, error.hint)))
        return [failed(name, words, unit=unit, why=why) for name, words, unit in _names(target)]
    return [row for split in SPLITS for row in _split_rows(source, found, split)]


def _names(target: Target) -> Iterator[tuple[str, str, str]]:
    """Name, case and unit of each row that scores make."""
    words = WORDS[target]
    for split in SPLITS:
        for way in NULLS:
            yield f"learned_{words}_ratio_{way}_{split}", "shipped weights", "1"
        yield f"learned_{words}_over_peak_{split}", "shipped weights", "1"
        if target is Target.FORCE:
            for axis in PLACES:
                yield f"learned_total_force_{split}", axis, target.unit


def _split_rows(source: Source, found: FieldResult, split: Split) -> Iterator[Row]:
    target, words = found.target, WORDS[found.target]
    members = found.of(split)
    if not members:
        for name, case, unit in _names(target):
            if name.endswith(f"_{split}"):
                yield failed(name, case, unit=unit, why=f"no sample of the split {split}")
        return
    one = compared(members)
    case = (
        f"{found.weights} on {one.learned.samples} samples of {one.cases} {split} cases, data set "
        f"{source.key[:8]}"
    )
    for way, null in NULLS.items():
        yield _ratio_row(f"learned_{words}_ratio_{way}_{split}", case, one, target, way, null)
    paper = published.over_peak(target, one.learned.peak, source.skin.areas_mm2)
    yield stated(
        f"learned_{words}_over_peak_{split}",
        f"mean absolute error {one.learned.mae:.3g} {target.unit} over the peak "
        f"{one.learned.peak:.3g} {target.unit}; reference: the paper's "
        f"{published.MAE[target]:.3g} {target.unit} carried to this mesh, over our peak; {case}",
        one.learned.over_peak,
        unit="1",
        reference=paper,
        null=one.ways[Way.ZERO].over_peak,
    )
    if target is Target.FORCE:
        yield from _total_rows(f"learned_total_force_{split}", case, one)


def _ratio_row(name: str, case: str, one: Compared, target: Target, way: Way, null: Way) -> Row:
    text = f"learned error over that of {way}; null: {null} over {way}; {case}"
    limit = LIMITS[target].get(way)
    value, other = one.error_ratio(Way.LEARNED, way), one.error_ratio(null, way)
    if limit is None:
        return stated(name, text, value, unit="1", null=other)
    return bounded(name, text, value, unit="1", limit=limit, null=other)


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


def advice_row() -> Row:
    """Whether what the browser advises rests on today's networks and code; null: no advice."""
    return bounded(
        "learned_advice",
        "errors by source and kind of contact that advice is composed from",
        lambda: float(len(ERRORS.figures()["rows"])),
        unit="1",
        limit=1.0,
        sense="min",
        null=0.0,
        record=ERRORS,
    )


def sparse_rows() -> list[Row]:
    """Sparse convolutions against dense ones; null: one that looks at no neighbour."""

    def difference(kind: str, *, own: bool = False) -> Callable[[], float]:
        def measure() -> float:
            from sim.forces.network.checks import sparse_dense_difference
            from workbench.proof.benchmarks.forces import shell

            points_mm = shell(CONVOLUTION_POINTS)
            return sparse_dense_difference(points_mm, double=kind == "float64", own_voxel_only=own)

        return measure

    return [
        bounded(
            "learned_sparse_equals_dense",
            f"{kind}: kernels of 5 and 3, gathered and as pairs, and steps of 2 on "
            f"{CONVOLUTION_POINTS} points, largest difference over the largest value",
            difference(kind),
            unit="1",
            limit=limit,
            null=difference(kind, own=True),
        )
        for kind, limit in SPARSE_LIMITS.items()
    ]
