"""A map of the skin for the eye: colours of the vertices, ends of the scale, scores as rows.

The scale goes from the 5th to the 95th percentile, so that a few odd places do not wash out the
rest; maps that are 0 or 1 keep that scale, and their blind places are grey.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim.optics.maps.map_kind import map_kinds
from workbench.core.result.maps import PERCENTILES, DesignerMaps, SkinMap
from workbench.view.colour_scale import scale_colours
from workbench.view.metric_rules import RULES, rule
from workbench.view.scene_shapes import first_hit

BETTER = {"more": "high", "less": "low"}
LEAST_SPAN = 1e-6
"""Ends of a scale that are nearer than this differ by rounding only, in any unit of the maps."""


@dataclass(frozen=True, kw_only=True, slots=True)
class MapLook:
    """A map, ready for the 3D view."""

    colours: np.ndarray
    """Of each vertex, shape (V, 3), uint8."""
    low: float
    middle: float
    """Median over the seen skin; NaN where nothing is seen."""
    high: float
    words: str
    """What the ends of the scale are, where they are percentiles."""


def map_look(found: SkinMap) -> MapLook:
    """Colours and scale of a map."""
    values = np.asarray(found.values, dtype=np.float64)
    flag = is_flag(found)
    low, high = (0.0, 1.0) if flag else scale_of(found)
    usual = (percentile(found, 5.0), percentile(found, 95.0)) == (low, high)
    shown = np.where(values > 0.0, values, np.nan) if flag else values
    return MapLook(
        colours=scale_colours(shown, low, high),
        low=low,
        middle=percentile(found, 50.0),
        high=high,
        words="" if flag or not usual else "5, 50 and 95 % of the skin",
    )


def is_flag(found: SkinMap) -> bool:
    """Whether a map says yes or no: all its values are 0 or 1."""
    values = np.asarray(found.values)
    finite = values[np.isfinite(values)]
    return bool(finite.size and np.isin(finite, (0.0, 1.0)).all())


def scale_of(found: SkinMap) -> tuple[float, float]:
    """Ends of the scale of colours, different from each other."""
    for lower, upper in ((5.0, 95.0), (0.0, 100.0)):
        low, high = percentile(found, lower), percentile(found, upper)
        if np.isfinite([low, high]).all() and high - low > LEAST_SPAN:
            return low, high
    level = percentile(found, 50.0)
    if not np.isfinite(level) or abs(level) < LEAST_SPAN:
        return 0.0, 1.0
    return min(0.0, level), max(0.0, level)


def percentile(found: SkinMap, share: float) -> float:
    """One of `PERCENTILES` of a map."""
    return float(found.percentiles[PERCENTILES.index(share)])


def value_at(
    found: SkinMap,
    points_mm: np.ndarray,
    faces: np.ndarray,
    origin: np.ndarray,
    direction: np.ndarray,
) -> tuple[np.ndarray, float] | None:
    """Place [mm] and value of a map where a ray first meets the skin from outside, or None.

    The value is that of the nearest corner of the triangle; NaN where there is none.
    """
    hit = first_hit(points_mm, faces, origin, direction)
    if hit is None:
        return None
    corners = np.asarray(faces)[hit[0]]
    nearest = corners[np.argmin(((np.asarray(points_mm)[corners] - hit[1]) ** 2).sum(axis=1))]
    return hit[1], float(found.values[nearest])


def value_words(found: SkinMap, value: float) -> str:
    """A value for people: with its unit, `blind` where there is none."""
    if not np.isfinite(value):
        return "blind here"
    if is_flag(found) and value == 0.0:
        return f"{yes_no(found)[1]} here"
    unit = "" if found.unit == "1" else f" {found.unit}"
    return f"{value:.3g}{unit}"


def yes_no(found: SkinMap) -> tuple[str, str]:
    """What 1 and 0 are called in a map that knows nothing else."""
    kind = map_kinds().get(found.name)
    return ("yes", "no") if kind is None else kind.yes_no


def heights_words(found: SkinMap, points_mm: np.ndarray) -> str:
    """Between what heights the skin lies of which a map that says yes or no says no; "" of none.

    Args:
        found: The map.
        points_mm: Its vertices, shape (V, 3).
    """
    z_mm = np.asarray(points_mm)[~(np.asarray(found.values) > 0.0), 2]
    if not len(z_mm):
        return ""
    low, high = (f"{height:.1f}".replace("-0.0", "0.0") for height in (z_mm.min(), z_mm.max()))
    return f"{yes_no(found)[1]}: skin at heights z from {low} to {high} mm"


def of_one_light(found: SkinMap) -> bool:
    """Whether a map is one of many alike: its figure stands on no score card."""
    return found.score_name not in RULES


def ordered(maps: DesignerMaps) -> list[SkinMap]:
    """The maps as they are listed: those of single lights, which may be many, come last."""
    return sorted(maps.maps, key=of_one_light)


def scores(maps: DesignerMaps) -> dict[str, float]:
    """Finite scores of the maps of a whole design by name; single lights are left out."""
    return {
        found.score_name: float(found.score)
        for found in maps.maps
        if np.isfinite(found.score) and not of_one_light(found)
    }


def score_rows(maps: DesignerMaps) -> list[tuple[str, str, str, str]]:
    """Label of the map, of its score, value with its unit, and which way is better, in order."""
    return [
        (
            found.label,
            rule(found.score_name).label,
            _amount(found.score, rule(found.score_name).unit),
            BETTER.get(found.better, found.better),
        )
        for found in ordered(maps)
    ]


def _amount(score: float, unit: str) -> str:
    return f"{score:.3g} {unit}".rstrip() if np.isfinite(score) else "-"
