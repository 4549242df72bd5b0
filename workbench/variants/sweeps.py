"""One-parameter sweeps: a design computed at some values of one number, and what came of each.

A sweep is a base state, a field and points. Results are stored by content like all others, so a
sweep that was cancelled or crashed goes on where it was: a point whose results are stored costs
nothing. A point that fails keeps its message, and the others are computed all the same. Here is the
bookkeeping; who runs the stages (the front's conductor, the command) hands the outcomes in.
"""

from __future__ import annotations

import dataclasses
import enum
import math
from collections.abc import Mapping
from dataclasses import dataclass, field

from workbench.core.base.errors import DesignError, WorkbenchError
from workbench.pipeline.store import Store
from workbench.planning.plan import plan
from workbench.project.state import State
from workbench.variants.score_card import figures
from workbench.variants.sweep_fields import SweepField, field_value, find_field, with_value
from workbench.variants.variants import KEPT

FEWEST, MOST = 2, 15
"""Points of a sweep."""
WANTED = ("shoot", "maps")
PARTS = ("mould", "housing", "recipe")
"""Further stages of a sweep that also counts the checks of fabrication."""
LEAST_S = 0.3
"""A point that took less was found in the store and says nothing about the next one [s]."""


class Status(enum.StrEnum):
    """How far a point is."""

    WAITING = "waiting"
    DONE = "done"
    FAILED = "failed"


@dataclass(frozen=True, kw_only=True, slots=True)
class Point:
    """One value of a sweep."""

    value: float
    status: Status = Status.WAITING
    message: str = ""
    """Why it failed, and what to do about it."""
    figures: Mapping[str, float] = field(default_factory=dict[str, float])
    keys: Mapping[str, str] = field(default_factory=dict[str, str])
    """Keys of its results by stage."""
    seconds: float = 0.0
    """Time it took [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Sweep:
    """A base, a field and its points."""

    name: str
    base: State
    path: str
    points: tuple[Point, ...]
    parts: bool = False
    """Whether moulds and housing are made too, for the counts of checks."""

    @property
    def field(self) -> SweepField:
        """What is swept.

        Raises:
            DesignError: If the base has no such field any more.
        """
        return find_field(self.base, self.path)

    @property
    def wanted(self) -> tuple[str, ...]:
        """Stages of each point."""
        return (*WANTED, *PARTS) if self.parts else WANTED

    @property
    def finished(self) -> int:
        """Points that are done or failed."""
        return sum(point.status is not Status.WAITING for point in self.points)


@dataclass(frozen=True, kw_only=True, slots=True)
class Span:
    """Values at equal distances, both ends included."""

    start: float
    """First value, in the field's own unit."""
    stop: float
    """Last value."""
    steps: int


def make_sweep(
    name: str,
    base: State,
    path: str,
    span: Span,
    *,
    parts: bool = False,
) -> Sweep:
    """A sweep that has not begun.

    Raises:
        DesignError: If the field cannot be swept, the ends are equal or not finite, the number of
            steps is out of its range, or the design refuses every value.
    """
    about = find_field(base, path)
    values = sweep_values(about, span)
    points = tuple(Point(value=value) for value in values)
    sweep = Sweep(name=name, base=base, path=about.path, points=points, parts=parts)
    refused = [refusal(sweep, number) for number in range(len(points))]
    first = refused[0]
    if first is not None and all(refused):
        raise first
    return sweep


def sweep_values(about: SweepField, span: Span) -> list[float]:
    """Values at equal distances, both ends included; of whole numbers each once.

    Raises:
        DesignError: If the ends are equal or not finite, or the steps out of range.
    """
    start, stop, steps = span.start, span.stop, span.steps
    if not (math.isfinite(start) and math.isfinite(stop)) or start == stop:
        raise DesignError(
            f"a sweep from {start:g} to {stop:g} {about.unit} has no way to go",
            hint="give two different numbers",
            at="sweep",
        )
    if not FEWEST <= steps <= MOST:
        raise DesignError(
            f"a sweep of {steps} steps is outside {FEWEST} to {MOST}",
            hint=f"choose {FEWEST} to {MOST}; each is a whole press",
            at="sweep",
        )
    values = [start + (stop - start) * k / (steps - 1) for k in range(steps)]
    # Rounded, so that 0.1 + 0.2 has the key of 0.3 and a point is found again.
    values = [float(round(v)) if about.whole else float(f"{v:.9g}") for v in values]
    return list(dict.fromkeys(values))


def state_at(sweep: Sweep, number: int) -> State:
    """Design and press of a point.

    Raises:
        DesignError: If the design refuses the value.
    """
    return with_value(sweep.base, sweep.field, sweep.points[number].value)


def refusal(sweep: Sweep, number: int) -> DesignError | None:
    """Why the design refuses the value of a point, None where it does not."""
    try:
        state = state_at(sweep, number)
        plan(state.design, state.case)
    except DesignError as error:
        return error
    return None


def todo(sweep: Sweep, store: Store) -> list[int]:
    """Points to compute: waiting ones, and those whose results were cleared from the store.

    Where none is, the failed ones: whoever asks again has perhaps mended something.
    """
    waiting = [k for k, p in enumerate(sweep.points) if p.status is Status.WAITING]
    waiting += lost(sweep, store)
    failed = [k for k, p in enumerate(sweep.points) if p.status is Status.FAILED]
    return sorted(waiting) or failed


def lost(sweep: Sweep, store: Store) -> list[int]:
    """Points that are done but whose images were cleared from the store."""
    return [
        number
        for number, point in enumerate(sweep.points)
        if point.status is Status.DONE and not store.has("shoot", point.keys.get("shoot", "none"))
    ]


def done(sweep: Sweep, number: int, store: Store, seconds: float) -> Sweep:
    """The sweep with the stored results of a point taken in.

    Raises:
        StoreError: If a result is damaged.
    """
    state = state_at(sweep, number)
    calls = plan(state.design, state.case)
    keys = {s: calls[s].key for s in KEPT if s in calls and store.has(s, calls[s].key)}
    point = Point(
        value=sweep.points[number].value,
        status=Status.DONE,
        figures=figures(store, state, keys),
        keys=keys,
        seconds=seconds,
    )
    return _with_point(sweep, number, point)


def failed(sweep: Sweep, number: int, error: WorkbenchError) -> Sweep:
    """The sweep with the message of a point that failed."""
    hint = "" if "\n" in error.hint else error.hint
    message = "; ".join(part for part in (error.message, hint) if part)
    point = Point(value=sweep.points[number].value, status=Status.FAILED, message=message)
    return _with_point(sweep, number, point)


def _with_point(sweep: Sweep, number: int, point: Point) -> Sweep:
    points = (*sweep.points[:number], point, *sweep.points[number + 1 :])
    return dataclasses.replace(sweep, points=points)


def seconds_left(sweep: Sweep, left: int, running_s: float = 0.0) -> float | None:
    """Time until the end at the pace of the points so far [s]; None before the first.

    Args:
        sweep: With the points that are done.
        left: Points to go, the running one among them.
        running_s: How long that has run [s].
    """
    paces = [point.seconds for point in sweep.points if point.seconds > LEAST_S]
    if not paces or not left:
        return None
    pace = sum(paces) / len(paces)
    return max(pace - running_s, 0.0) + pace * (left - 1)


def curve(sweep: Sweep, metric: str) -> tuple[list[float], list[float]]:
    """Values in rising order and the figure at each, where it exists."""
    found = [(p.value, p.figures[metric]) for p in sweep.points if metric in p.figures]
    found.sort()
    return [x for x, _ in found], [y for _, y in found]


def metrics_of(sweep: Sweep) -> list[str]:
    """Figures that any point has."""
    names = dict.fromkeys(name for point in sweep.points for name in point.figures)
    return [name for name in names if name != "press_depth_mm" or sweep.path.endswith(name)]


def base_value(sweep: Sweep) -> float:
    """The value that the base has."""
    return field_value(sweep.base, sweep.path)
