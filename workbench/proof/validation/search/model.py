"""What a search would be told of designs between those that were evaluated: a model of them.

A smooth surface (`surface`) goes through each figure of the designs that were judged, through its
logarithm where it is positive; another one, of 1 where a design was judged and -1 where it was
refused, is cut at 0. So a sampler may propose any design, and is answered at once. The designs that
were evaluated are the data; none of them is altered.

What this can tell: which sampler finds more of a response that is as smooth, as curved and as often
refused as the real one. What it cannot: more than the error of the surfaces, which is stated beside
every comparison; steps that are finer than the designs lie apart, which a surface smooths away; the
noise of photons, that the real response has and this one has not. A Gaussian process is what made
the surfaces and what proposes in the default search, too, which may favour that. Answering with the
nearest evaluated design instead would need no model, but has no slope for any sampler to find, and
400 points in 8 dimensions are the Sobol sequence itself, which then could not lose. In the corners
of the box, where optimisers go, a model of spread designs is far too kind; so designs on the fronts
that were found are evaluated for real (`confirmed`), and the model is made once more with them.
"""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from workbench.core.base.errors import DesignError
from workbench.core.base.monitor import Monitor
from workbench.proof.validation.search.samples import BASE, Sample
from workbench.proof.validation.search.surface import Surface, fit_surface
from workbench.search.judged import Judged, Status
from workbench.search.problem import Problem, Value, Vary

OF_THE_PRESS = ("build", "mesh", "lattice", "press")
"""Stages that trials of a group share."""
FEWEST = 20
"""Designs that are judged, for a surface; our choice."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Cost:
    """How long a design takes, by medians [s]."""

    judged_s: float
    """Of one that is judged."""
    refused_s: float
    press_s: float
    """Part of one that is judged which trials of a group share."""


@dataclass(frozen=True, kw_only=True, slots=True)
class FigureSurface:
    """A figure over the box."""

    surface: Surface
    is_log: bool
    """Whether the surface is of its logarithm."""

    def at(self, point: np.ndarray) -> float:
        """The figure at a point (D,) of the unit cube, in its own unit."""
        return float(self._own(self.surface.at(point[None]))[0])

    @property
    def error(self) -> float:
        """Root mean square of what leaving one design out predicts wrongly, over the deviation of
        the figure [1]: 0 is exact, 1 is as good as the mean. Lengths are those of all designs."""
        values = self._own(self.surface.values)
        off = self._own(self.surface.left_out) - values
        deviation = float(values.std())
        return float(np.sqrt((off**2).mean())) / deviation if deviation else 0.0

    def _own(self, values: np.ndarray) -> np.ndarray:
        return np.exp(values) if self.is_log else values


class Model:
    """Judges designs of a problem by surfaces; an `Evaluator` of a search.

    Args:
        problem: What varies, and which figures count.
        samples: What was evaluated, the base among it.
        of_the_press: Varied fields that trials of a group share.
        added: Designs that only the surfaces know of, beside those spread over the box.

    Raises:
        DesignError: If there is no base, or too few designs were judged.
    """

    def __init__(
        self,
        problem: Problem,
        samples: Sequence[Sample],
        of_the_press: frozenset[str],
        added: Sequence[Sample] = (),
    ) -> None:
        self.problem, self.of_the_press = problem, of_the_press
        bases = [one for one in samples if one.number == BASE]
        self.samples = [one for one in samples if one.number != BASE]
        self.known = [*self.samples, *added]
        judged = [one for one in self.known if one.judged.status is Status.JUDGED]
        if not bases or len(judged) < FEWEST:
            raise DesignError(
                f"{len(bases)} base and {len(judged)} judged designs are too few for a model",
                hint="go on with workbench.proof.validation.search.response",
            )
        self.base = bases[0].judged
        self.surfaces = {name: _figure(problem, judged, name) for name in figure_names(problem)}
        self._pressed: set[tuple[Value, ...]] = set()

    @functools.cached_property
    def builds(self) -> Surface | None:
        """Above 0 where a design is judged; None where every one was."""
        told = [1.0 if one.judged.status is Status.JUDGED else -1.0 for one in self.known]
        if min(told) > 0.0:
            return None
        return fit_surface(unit_points(self.problem.vary, self.known), np.array(told))

    @property
    def wrong_share(self) -> float:
        """Share of designs whose refusal the others predict wrongly [1]."""
        if self.builds is None:
            return 0.0
        return float(((self.builds.left_out > 0.0) != (self.builds.values > 0.0)).mean())

    @property
    def refused_share(self) -> float:
        """Share of designs that were refused or failed [1]."""
        return float(np.mean([one.judged.status is not Status.JUDGED for one in self.samples]))

    @functools.cached_property
    def cost(self) -> Cost:
        """How long designs take."""
        judged = [one for one in self.samples if one.judged.status is Status.JUDGED]
        refused = [one for one in self.samples if one.judged.status is Status.REFUSED]
        judged_s = _median([one.judged.seconds for one in judged])
        shared = [sum(one.stage_s.get(stage, 0.0) for stage in OF_THE_PRESS) for one in judged]
        return Cost(
            judged_s=judged_s,
            refused_s=_median([one.judged.seconds for one in refused]) if refused else judged_s,
            press_s=_median(shared) if self.of_the_press else 0.0,
        )

    def judge(self, values: Mapping[str, Value], monitor: Monitor) -> Judged:
        """What the surfaces say of these values, and how long the design would take."""
        point = unit_point(self.problem.vary, values)
        if self.builds is not None and self.builds.at(point[None])[0] <= 0.0:
            return Judged(
                status=Status.REFUSED,
                reason="refused by the model",
                seconds=self.cost.refused_s,
                parameters=values,
            )
        group = tuple(values[path] for path in sorted(self.of_the_press))
        known = bool(group) and group in self._pressed
        self._pressed.add(group)
        return Judged(
            status=Status.JUDGED,
            figures={name: each.at(point) for name, each in self.surfaces.items()},
            seconds=self.cost.judged_s - (self.cost.press_s if known else 0.0),
            ran={} if known or not group else {"press": 1},
            found={"press": 1} if known else {},
            parameters=values,
        )

    def judge_base(self, monitor: Monitor) -> Judged:
        """The base as it was evaluated."""
        return self.base

    def forget(self) -> None:
        """Begin another search: no press is known."""
        self._pressed.clear()


def figure_names(problem: Problem) -> tuple[str, ...]:
    """Figures of goals and limits, each once."""
    return tuple(dict.fromkeys(one.figure for one in (*problem.goals, *problem.limits)))


def unit_points(vary: Sequence[Vary], samples: Sequence[Sample]) -> np.ndarray:
    """Designs as points of the unit cube, shape (N, D)."""
    return np.array([unit_point(vary, one.values) for one in samples])


def unit_point(vary: Sequence[Vary], values: Mapping[str, Value]) -> np.ndarray:
    """A design as a point of the unit cube, shape (D,); choices have an axis each but for the
    first, 0 or 1."""
    return np.array([x for each in vary for x in _units(each, values[each.path])])


def _units(vary: Vary, value: Value) -> list[float]:
    if vary.choices:
        return [float(value == choice) for choice in vary.choices[1:]]
    number = float(value)
    if vary.log:
        return [float(np.log(number / vary.low) / np.log(vary.high / vary.low))]
    return [(number - vary.low) / (vary.high - vary.low)]


def _figure(problem: Problem, judged: Sequence[Sample], name: str) -> FigureSurface:
    values = np.array([one.judged.figures[name] for one in judged])
    is_log = bool((values > 0.0).all())
    points = unit_points(problem.vary, judged)
    surface = fit_surface(points, np.log(values) if is_log else values)
    return FigureSurface(surface=surface, is_log=is_log)


def _median(values: Sequence[float]) -> float:
    return float(np.median(values))
