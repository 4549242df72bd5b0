"""From values on the skin to a figure: area-weighted percentiles, and the score card's scalar."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from workbench.core.result.maps import PERCENTILES

WASHED_OUT = 1.0
"""Glare over the skin's own radiance from which a place counts as washed out [1]."""
REACHED = 0.1
"""Light of an LED over its brightest from which a place counts as reached [1]."""

Score = Callable[[np.ndarray, np.ndarray, np.ndarray], float]
"""Of known values (N,), their areas (N,) and `PERCENTILES` of them: the figure."""


def weighted_percentiles(values: np.ndarray, weights: np.ndarray) -> np.ndarray:
    """`PERCENTILES` of values (N,) with weights (N,), shape (7,); NaN of none."""
    if not values.size or weights.sum() <= 0.0:
        return np.full(len(PERCENTILES), np.nan)
    order = np.argsort(values)
    share = np.cumsum(weights[order]) - weights[order] / 2.0
    return np.interp(np.array(PERCENTILES) / 100.0 * weights.sum(), share, values[order])


def median(values: np.ndarray, areas: np.ndarray, marks: np.ndarray) -> float:
    """Half the skin is better, half worse."""
    return float(marks[3])


def evenness(values: np.ndarray, areas: np.ndarray, marks: np.ndarray) -> float:
    """The 5th over the 95th percentile."""
    return float(marks[1] / marks[5]) if marks[5] > 0.0 else 0.0


def mean_percent(values: np.ndarray, areas: np.ndarray, marks: np.ndarray) -> float:
    """Of values from 0 to 1."""
    return 100.0 * float((values * areas).sum()) / _whole(areas)


def washed_out_percent(values: np.ndarray, areas: np.ndarray, marks: np.ndarray) -> float:
    """Share of the skin above `WASHED_OUT`."""
    return 100.0 * float(areas[values > WASHED_OUT].sum()) / _whole(areas)


def reached_percent(values: np.ndarray, areas: np.ndarray, marks: np.ndarray) -> float:
    """Share of the skin from `REACHED`."""
    return 100.0 * float(areas[values >= REACHED].sum()) / _whole(areas)


def _whole(areas: np.ndarray) -> float:
    return max(float(areas.sum()), 1e-300)
