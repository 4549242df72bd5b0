"""The charts of an evaluation: errors by object, place, depth and way aside, and the data's spread.

Presses and shears stand apart. The paper's Fig. 14 has places and depths.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from workbench.learning.evaluation import charts
from workbench.learning.evaluation.evaluate import FieldResult
from workbench.learning.evaluation.groups import (
    by_station,
    depth_of,
    shear_of,
    station_of,
    station_words,
)
from workbench.learning.evaluation.html_tables import FIELD_WORDS
from workbench.learning.evaluation.scoring import Compared, Scored, Way, grouped
from workbench.learning.evaluation.sheets import Spread


def field_charts(found: FieldResult) -> list[str]:
    """By object, station, depth and way aside; presses and shears apart."""
    what = f"mean error of {FIELD_WORDS[found.target]} [{found.target.unit}]"
    pressed = [sample for sample in found.samples if not sample.sheared]
    sheared = [sample for sample in found.samples if sample.sheared]
    places = station_words(found.samples[0].case)
    drawn = [_bars(found.samples, f"By object: {what}")]
    for words, samples in (("Presses", pressed), ("Shears", sheared)):
        if samples:
            title = f"{words} by place: {what}"
            drawn.append(_lines(by_station(samples), station_of, title, places))
    if pressed:
        by_depth = sorted(pressed, key=lambda sample: sample.depth_mm)
        title = f"Presses by depth: {what}"
        drawn.append(_lines(by_depth, depth_of, title, "depth from first touch [mm]"))
    if sheared:
        by_way = sorted(sheared, key=lambda sample: sample.shear_mm)
        title = f"Shears by way aside: {what}"
        drawn.append(_lines(by_way, shear_of, title, "way aside along U or V, the larger [mm]"))
    return drawn


def _series(groups: Mapping[str, Compared]) -> dict[str, list[float]]:
    return {way.value: [one.ways[way].mae for one in groups.values()] for way in Way}


def _lines(samples: list[Scored], name: Callable[[Scored], str], title: str, below: str) -> str:
    groups = grouped(samples, name)
    return charts.lines(title, list(groups), _series(groups), below=below)


def _bars(samples: Sequence[Scored], title: str) -> str:
    groups = grouped(samples, lambda sample: sample.case.indenter.value.replace("_", " "))
    return charts.bars(title, list(groups), _series(groups), below="")


def spread_charts(found: Spread) -> str:
    """How many samples press how deep and how hard; depths are steps, so each has its own bar."""
    count = len(found.depths_mm)
    depths, each = np.unique(found.depths_mm.round(6), return_counts=True)
    drawn = [
        charts.bars(
            f"Depth of {count:,} samples",
            [f"{depth:.3g}" for depth in depths],
            {"samples": each.astype(float).tolist()},
            below="depth from first touch [mm]; shears stay at theirs",
        ),
        charts.histogram(
            f"Total force of {count:,} samples",
            found.forces_N.tolist(),
            below="length of the total force by finite elements [N]",
        ),
    ]
    return f"<div class='images'>{''.join(drawn)}</div>"
