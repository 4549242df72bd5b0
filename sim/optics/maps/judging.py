"""From values on the skin to a map: area-weighted percentiles, and the score card's scalar."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from workbench.core.maps import PERCENTILES, SkinMap

WASHED_OUT = 1.0
"""Glare over the skin's own radiance from which a place counts as washed out [1]."""
REACHED = 0.1
"""Light of an LED over its brightest from which a place counts as reached [1]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Draft:
    """A map before its percentiles are taken."""

    name: str
    label: str
    unit: str
    values: np.ndarray
    score_name: str
    score: str
    """How the scalar comes from the values: see `_score`."""
    better: str
    meaning: str


def judged(draft: Draft, areas: np.ndarray) -> SkinMap:
    """The map of a draft; `areas` [mm2] of the vertices, shape (V,)."""
    known = np.isfinite(draft.values)
    values, weights = draft.values[known].astype(np.float64), areas[known]
    marks = weighted_percentiles(values, weights)
    return SkinMap(
        name=draft.name,
        label=draft.label,
        unit=draft.unit,
        values=draft.values,
        percentiles=marks,
        score_name=draft.score_name,
        score=_score(draft.score, values, weights, marks),
        better=draft.better,
        meaning=draft.meaning,
    )


def weighted_percentiles(values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """`PERCENTILES` of values (N,) with weights (N,), shape (7,); NaN of none."""
    if not values.size or weights.sum() <= 0.0:
        return np.full(len(PERCENTILES), np.nan)
    order = np.argsort(values)
    share = np.cumsum(weights[order]) - weights[order] / 2.0
    return np.interp(np.array(PERCENTILES) / 100.0 * weights.sum(), share, values[order])


def _score(kind: str, values: np.ndarray, weights: np.ndarray, marks: np.ndarray) -> float:
    total = max(float(weights.sum()), 1e-300)
    if kind == "percent":
        return 100.0 * float((values * weights).sum()) / total
    if kind == "share_over_1":
        return 100.0 * float(weights[values > WASHED_OUT].sum()) / total
    if kind == "reach":
        return 100.0 * float(weights[values >= REACHED].sum()) / total
    if kind == "evenness":
        return float(marks[1] / marks[5]) if marks[5] > 0.0 else 0.0
    return float(marks[3])
