"""One search by one sampler on a response that answers at once, with the time that it would take.

The loop is the product's own. Time is that of the designs, by the response, and that of the
sampler's thinking and noting, by the processor time of this process; so what else runs on the
machine does not count. A search goes on until its trials and its minutes are both used up.
"""

from __future__ import annotations

import contextlib
import dataclasses
import tempfile
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from workbench.core.base.errors import Cancelled
from workbench.core.base.monitor import Monitor
from workbench.proof.validation.search.samplers import proposing
from workbench.search.front import hypervolume, keeps_limits
from workbench.search.journal import FILE
from workbench.search.judged import Evaluator, Judged, Status
from workbench.search.loop import Budget, search
from workbench.search.problem import Problem, Value

MOST_TIMES = 4
"""Trials at which a search ends that has minutes left, over those that were wanted."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Step:
    """A proposal, and what came of it."""

    values: Mapping[str, Value]
    losses: tuple[float, ...] | None
    """Of the goals; None where it was refused, failed, or breaks a limit."""
    counts: bool
    """Whether it is a trial: one that was refused is none."""
    thought_s: float
    """Processor time since the end of the one before [s]."""
    design_s: float
    """What the design takes [s]."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Scale:
    """How losses become a hypervolume: between the best and the worst of some designs."""

    low: np.ndarray
    """Least losses, shape (K,)."""
    high: np.ndarray
    """Most losses, shape (K,): the reference point."""
    whole: float
    """Hypervolume of these designs, of losses between 0 and 1."""

    def share(self, losses: Sequence[Sequence[float]]) -> float:
        """Hypervolume of losses (N, K) over that of the designs of this scale [1]."""
        points = np.array(losses, float).reshape(-1, len(self.low))
        return _volume(points, self.low, self.high) / self.whole


def scale_of(losses: np.ndarray) -> Scale:
    """The scale of designs with losses (N, K), of which some beat the worst in every goal."""
    low, high = losses.min(axis=0), losses.max(axis=0)
    return Scale(low=low, high=high, whole=_volume(losses, low, high))


def _volume(losses: np.ndarray, low: np.ndarray, high: np.ndarray) -> float:
    return hypervolume((losses - low) / (high - low), np.ones(len(low)))


class Recorder:
    """Hands designs on to an evaluator, notes what came of each, and ends the search in time.

    Args:
        problem: What is looked for.
        evaluator: Who judges.
        trials: Least trials.
        spent_s: Least time, of thinking and designs [s].
    """

    def __init__(
        self, problem: Problem, evaluator: Evaluator, *, trials: int, spent_s: float
    ) -> None:
        self.problem, self.evaluator = problem, evaluator
        self.trials, self.spent_s = trials, spent_s
        self.steps: list[Step] = []
        self._since = time.process_time()

    @property
    def of_the_press(self) -> frozenset[str]:
        """Of the evaluator."""
        return self.evaluator.of_the_press

    def judge(self, values: Mapping[str, Value], monitor: Monitor) -> Judged:
        """What the evaluator says.

        Raises:
            Cancelled: Once trials and time are used up.
        """
        thought_s = time.process_time() - self._since
        counted = sum(step.counts for step in self.steps)
        spent_s = sum(step.thought_s + step.design_s for step in self.steps)
        if counted >= self.trials and spent_s >= self.spent_s:
            raise Cancelled("trials and minutes are used up")
        judged = self.evaluator.judge(values, monitor)
        self.steps.append(
            Step(
                values=values,
                losses=losses_of(self.problem, judged),
                counts=judged.status is not Status.REFUSED,
                thought_s=thought_s,
                design_s=judged.seconds,
            )
        )
        self._since = time.process_time()
        return judged

    def judge_base(self, monitor: Monitor) -> Judged:
        """What the evaluator says of the base; that is no trial."""
        judged = self.evaluator.judge_base(monitor)
        self._since = time.process_time()
        return judged


def losses_of(problem: Problem, judged: Judged) -> tuple[float, ...] | None:
    """Of the goals, None of a design that is not allowed."""
    whole = judged.status is Status.JUDGED
    if not whole or not keeps_limits(problem, judged.figures):
        return None
    return tuple(goal.loss(judged.figures[goal.figure]) for goal in problem.goals)


def searched(
    problem: Problem, evaluator: Evaluator, sampler: str, *, trials: int, spent_s: float
) -> list[Step]:
    """All proposals of one search, in their order.

    Args:
        problem: What is looked for, with the seed.
        evaluator: Who judges.
        sampler: One of `samplers.SAMPLERS`.
        trials: Least trials.
        spent_s: Least time, of thinking and designs [s].

    Raises:
        SearchError: If nearly every proposal is refused.
    """
    recorder = Recorder(problem, evaluator, trials=trials, spent_s=spent_s)
    most = Budget(trials=MOST_TIMES * trials)
    with tempfile.TemporaryDirectory() as folder, contextlib.suppress(Cancelled):
        search(problem, recorder, Path(folder) / FILE, most, proposing=proposing(sampler))
    return recorder.steps


def with_seed(problem: Problem, seed: int) -> Problem:
    """The same search by other chances."""
    return dataclasses.replace(problem, seed=seed)


def within_trials(steps: Sequence[Step], trials: int) -> list[Step]:
    """Proposals up to a number of trials."""
    counts = np.cumsum([step.counts for step in steps])
    return list(steps[: int(np.searchsorted(counts, trials)) + 1])


def within_time(steps: Sequence[Step], spent_s: float) -> list[Step]:
    """Proposals whose designs had ended after a time [s]."""
    ends = np.cumsum([step.thought_s + step.design_s for step in steps])
    return list(steps[: int(np.searchsorted(ends, spent_s, side="right"))])


def losses_in(steps: Sequence[Step]) -> list[tuple[float, ...]]:
    """Losses of those that are allowed."""
    return [step.losses for step in steps if step.losses is not None]
