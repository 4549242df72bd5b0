"""What a comparison comes to, figure by figure: values of both with their unit, and the better one.

Only the figures that say most stand here, first those that a designer decides by; tables have all.
"""

from __future__ import annotations

from collections.abc import Sequence

from workbench.variants.comparison import Change, number_text
from workbench.view.metric_rules import Better

MOST_FIGURES = 3
"""Figures that are told of each verdict; of the others only how many there are."""
VERDICTS = {"better": "B is better", "worse": "A is better", "": "A matter of choice"}
"""Verdicts on B, and how a line of each begins."""


def sentences(found: Sequence[Change]) -> list[str]:
    """A line for each verdict: what B is better in, what A is, and what is neither."""
    lines = []
    for verdict, head in VERDICTS.items():
        rows = [row for row in found if _counts(row) and row.verdict == verdict]
        rows.sort(key=lambda row: (not row.rule.chief, -abs(row.percent or 0.0)))
        if rows:
            more = len(rows) - MOST_FIGURES
            parts = [_figure(row) for row in rows[:MOST_FIGURES]]
            parts += [f"and {more} more"] if more > 0 else []
            lines.append(f"{head}: {'; '.join(parts)}.")
    return lines


def _counts(row: Change) -> bool:
    """Whether both have the figure; of what is a matter of choice, whether one decides by it."""
    if row.a is None or row.b is None or row.verdict == "same":
        return False
    return row.rule.better is not Better.NEUTRAL or row.rule.chief


def _figure(row: Change) -> str:
    unit = f" {row.rule.unit}" if row.rule.unit else ""
    way = "" if row.rule.better is Better.NEUTRAL else f" ({row.rule.better.value})"
    return f"{row.rule.label} A {number_text(row.a)}, B {number_text(row.b)}{unit}{way}"
