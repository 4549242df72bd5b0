"""The score card: figures of designs side by side, the best of each marked.

Figures are read from what is stored; none is computed here. One that is missing says what to run,
unless its stage ran and left it out because it does not exist for that design.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

from workbench.core.base.units import volume_ml
from workbench.core.result.fabrication import Severity
from workbench.core.result.sensing import Shot
from workbench.pipeline.store import Store
from workbench.project.state import State
from workbench.view.map_display import scores
from workbench.view.metric_rules import REMEDIES, RULES, Better, Rule, rule

Figures = Mapping[str, float]
SAME = 1e-3
"""Figures that differ by less than this share are called the same: the contact solver settles to
a residual of 1e-3, so that less is not for either design."""


def figures(store: Store, state: State, keys: Mapping[str, str]) -> dict[str, float]:
    """All finite figures of a design whose results are stored.

    Args:
        store: Where the results are.
        state: The design and its press.
        keys: Keys of results by stage.

    Raises:
        StoreError: If a result is damaged.
    """
    there = {stage: key for stage, key in keys.items() if store.has(stage, key)}
    found = {"press_depth_mm": state.case.press.depth_mm}
    if "shoot" in there:
        shot: Shot = store.load("shoot", there["shoot"])
        found |= shot.metrics.values
    if "maps" in there:
        found |= scores(store.load("maps", there["maps"]))
    if "build" in there:
        millilitres = volume_ml(store.load("build", there["build"]).volume_mm3)
        found["membrane_ml"] = millilitres
        # 1 g/cm3 is 1 g/ml.
        found["membrane_g"] = millilitres * state.design.material.density_g_cm3
    if "mould" in there:
        found |= _checks(store, there)
    return finite_figures(found)


def finite_figures(values: Mapping[str, float]) -> dict[str, float]:
    """The figures that are finite numbers."""
    return {name: float(value) for name, value in values.items() if math.isfinite(value)}


def _checks(store: Store, keys: Mapping[str, str]) -> dict[str, float]:
    """How many checks of the mould, and of the other parts where they are stored, came out how."""
    count: Counter[Severity] = Counter()
    for stage in ("mould", "housing", "recipe"):
        if stage in keys:
            count.update(check.severity for check in store.load(stage, keys[stage]).checks)
    return {f"checks_{severity.value}": float(count[severity]) for severity in Severity}


@dataclass(frozen=True, kw_only=True, slots=True)
class Cell:
    """A figure of one design."""

    value: float | None
    best: bool = False
    remedy: str = ""
    """What to run where the figure is missing; "" where that would not give it."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Line:
    """One figure of all designs."""

    rule: Rule
    cells: tuple[Cell, ...]


@dataclass(frozen=True, kw_only=True, slots=True)
class Card:
    """Figures by designs."""

    names: tuple[str, ...]
    lines: tuple[Line, ...]


def card(designs: Sequence[tuple[str, Figures]], *, chief_only: bool = False) -> Card:
    """The score card of designs in their order.

    Args:
        designs: Name and figures of each.
        chief_only: Only the figures that a designer decides by.
    """
    names = [name for name in RULES if not chief_only or RULES[name].chief]
    if not chief_only:
        others = {name for _, values in designs for name in values} - set(RULES)
        names += sorted(others)
    lines = [_line(rule(name), [values for _, values in designs]) for name in names]
    shown = [line for line in lines if line.rule.chief or _known(line)]
    return Card(names=tuple(name for name, _ in designs), lines=tuple(shown))


def _known(line: Line) -> bool:
    return any(cell.value is not None for cell in line.cells)


def _line(about: Rule, designs: Sequence[Figures]) -> Line:
    best = best_of(about, [values.get(about.name) for values in designs])
    cells = [
        Cell(
            value=values.get(about.name),
            best=number in best,
            remedy="" if about.name in values else remedy(about, values),
        )
        for number, values in enumerate(designs)
    ]
    return Line(rule=about, cells=tuple(cells))


def remedy(about: Rule, values: Figures) -> str:
    """What to run for a missing figure; "" where its stage has run without giving it."""
    ran = any(rule(name).stage == about.stage for name in values)
    return "" if ran else REMEDIES.get(about.stage, "")


def best_of(about: Rule, values: Sequence[float | None]) -> set[int]:
    """Numbers of the designs that have the best value; none where nothing is better."""
    known = {k: v for k, v in enumerate(values) if v is not None and math.isfinite(v)}
    if about.better is Better.NEUTRAL or len(known) < 2:
        return set()
    best = (max if about.better is Better.HIGHER else min)(known.values())
    chosen = {k for k, v in known.items() if equal(v, best)}
    return set() if len(chosen) == len(known) else chosen


def equal(a: float, b: float) -> bool:
    """Whether two figures are the same, to what the solvers settle to."""
    return math.isclose(a, b, rel_tol=SAME, abs_tol=1e-15)


def sorted_by(designs: Iterable[tuple[str, Figures]], metric: str) -> list[tuple[str, Figures]]:
    """Designs in the order of a figure: the best first, a neutral one rising, missing ones last."""
    sign = -1.0 if rule(metric).better is Better.HIGHER else 1.0

    def place(item: tuple[str, Figures]) -> tuple[bool, float, str]:
        value = item[1].get(metric, math.nan)
        known = math.isfinite(value)
        return not known, sign * value if known else 0.0, item[0]

    return sorted(designs, key=place)
