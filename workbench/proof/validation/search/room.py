"""The default search beside Sobol, random and TPE on two real problems, by a record.

Ours must be ahead in every seed: at equal trials, at equal minutes, and in what the designs of its
front are in truth. The first two are of a model of designs that were evaluated, whose error stands
beside them. All figures are the product's own, so rows say how well it finds what it computes, not
what a built sensor would show. Null is random.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from workbench.core.base.errors import StoreError
from workbench.proof.row import Row, bounded, failed, stated
from workbench.proof.validation.search import contest
from workbench.proof.validation.search.confirmed import MOST
from workbench.proof.validation.search.problems import LIGHT, TITLES
from workbench.proof.validation.search.response import COUNT
from workbench.proof.validation.search.samplers import OURS, RANDOM, SAMPLERS
from workbench.system.record import Record

NAME = "search_hypervolume"
GAIN_LIMIT = 0.2
"""By which the best design for light beats the preset in every goal."""
MEASURES = {
    NAME: ("at_trials", "at {trials} trials, on a model"),
    "search_hypervolume_minutes": (
        "at_minutes",
        "in the minutes that {trials} designs take, on a model",
    ),
    "search_hypervolume_true": (
        "share",
        f"of {MOST} designs of its front at {{trials}} trials, evaluated for real",
    ),
}
"""Rows, the figure that each shows, and its words."""


def rows(kept: Record = contest.RECORD) -> list[Row]:
    """All rows of the room; of a problem that is not on record one that is not met."""
    try:
        found = kept.figures()["problems"]
    except StoreError as error:
        return [failed(NAME, title, unit="1", why=error.message) for title in TITLES.values()]
    made: list[Row] = []
    for name, title in TITLES.items():
        if name in found:
            made += _rows(name, found[name], kept)
        else:
            why = f"its designs were not evaluated; make the record anew: {kept.command}"
            made.append(failed(NAME, title, unit="1", why=why))
    return made


def _rows(name: str, found: Mapping[str, Any], kept: Record) -> Iterator[Row]:
    whole = "" if found["designs"] >= COUNT else f" of {COUNT}, too few"
    begin = f"{TITLES[name]}, {found['designs']} designs{whole} and {found['added']} of fronts"
    for row, (figure, words) in MEASURES.items():
        told = found["true"] if row.endswith("_true") else found["runs"]
        shares = {(run["sampler"], run["seed"]): run[figure] for run in told}
        case = f"{begin}: {words.format(trials=found['trials'])}"
        yield from _pairs(row, case, shares, (found["ceiling"], kept))
    for figure, error in found["errors"].items():
        case = f"{begin}: {figure} of a design left out, error over the deviation; null: the mean"
        yield stated("search_model_error", case, error, unit="1", null=1.0, record=kept)
    usual = min(found["refused_share"], 1.0 - found["refused_share"])
    case = f"{begin}: refusals that the model has wrong; null: the more frequent answer"
    yield stated(
        "search_model_refusals", case, found["wrong_share"], unit="1", null=usual, record=kept
    )
    if found["front_error"] is not None:
        case = f"{begin}: error on its fronts, median of the worse goal; null: without those known"
        error, before = found["front_error"], found["first"]["front_error"]
        yield stated("search_front_error", case, error, unit="1", null=before, record=kept)
    yield from _gains(name, begin, found, kept)


def _pairs(
    name: str, case: str, shares: Mapping[tuple[str, int], float], of: tuple[float, Record]
) -> Iterator[Row]:
    """Ours beside each other sampler, seed by seed; only more is ahead."""
    ceiling, kept = of
    on_model = not name.endswith("_true")
    for seed in sorted({seed for _, seed in shares}):
        for other in SAMPLERS[1:]:
            yield bounded(
                name,
                f"{case}, ours against {other}, seed {seed}; over that of the designs",
                shares[OURS, seed],
                unit="1",
                limit=math.nextafter(shares[other, seed], math.inf),
                sense="min",
                null=shares[RANDOM, seed],
                ceiling=ceiling if on_model else None,
                record=kept,
            )


def _gains(name: str, begin: str, found: Mapping[str, Any], kept: Record) -> Iterator[Row]:
    """The least gain over the preset among the goals, evaluated by the preset's own settings."""
    for each in found["gains"]:
        case = f"{begin}: best design of seed {each['seed']} over the preset, in its worse goal"
        if each["own"] is None:
            yield failed("search_gain", case, unit="1", why="no design of the front is allowed")
        elif name == LIGHT:
            yield bounded(
                "search_gain",
                case,
                each["own"],
                unit="1",
                limit=GAIN_LIMIT,
                sense="min",
                null=0.0,
                record=kept,
            )
        else:
            yield stated("search_gain", case, each["own"], unit="1", null=0.0, record=kept)
