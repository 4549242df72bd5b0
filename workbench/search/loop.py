"""The loop of a search: propose, judge, note, until the trials or the minutes are over.

What is known stands in the journal before the next trial begins; so any number of processes work on
one search, and one that is killed loses only the trial that it was at.

A design that is refused has no figures, but the proposals must learn to stay away: it is noted with
the worst losses seen so far, and as beyond a constraint of its own. Limits that are not known of it
stand at their very end, which says nothing about them.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Protocol

from workbench.core.base.errors import Cancelled, WorkbenchError
from workbench.core.base.monitor import Monitor, part, silent
from workbench.search.journal import (
    BASE,
    JUDGED,
    SAMPLER,
    ended_trials,
    open_study,
    running_count,
)
from workbench.search.judged import Evaluator, Judged, Status, from_journal
from workbench.search.problem import Problem, Value
from workbench.search.proposing import Asking, Proposals

REFUSED = "refused"
"""The constraint that refused and failed trials are beyond."""
MOST_REFUSED = 25
"""Refusals for each trial that was wanted, before the search gives up."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Budget:
    """When to stop."""

    trials: int
    """Trials that are judged or failed, of all processes and runs; refusals are not counted."""
    minutes: float = float("inf")
    """Of this process."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Told:
    """A trial that has just ended."""

    number: int
    sampler: str
    judged: Judged
    counted: int
    """Trials so far that count."""
    wanted: int
    study: Any
    """All trials so far, an `optuna.Study`."""


class Proposing(Protocol):
    """Makes who is asked for values; in the product `Proposals`."""

    def __call__(self, study: Any, problem: Problem, *, grouped: frozenset[str]) -> Asking:
        """Who proposes to a study; `grouped` are fields that trials share in groups."""
        ...


class SearchError(WorkbenchError):
    """No design of a search can be built."""


def search(
    problem: Problem,
    evaluator: Evaluator,
    journal: Path,
    budget: Budget,
    *,
    monitor: Monitor = silent,
    on_trial: Callable[[Told], None] = lambda told: None,
    proposing: Proposing = Proposals,
) -> Any:
    """Work on a search; returns its study, an `optuna.Study`.

    Args:
        problem: What is looked for.
        evaluator: Who judges.
        journal: The file; a search that is there already goes on.
        budget: When to stop.
        monitor: Told how far it is; cancelling it loses only the running trial.
        on_trial: Told each trial that ends.
        proposing: Makes who proposes; another than the product's own to compare with.

    Raises:
        DesignError: If the journal is that of another search.
        SearchError: If nearly every proposal is refused.
        Cancelled: If the user asked to stop.
    """
    study = open_study(problem, journal)
    base = _base(study, evaluator, part(monitor, 0.0, 0.01))
    proposals = proposing(study, problem, grouped=_grouped(problem, evaluator))
    latest = time.monotonic() + 60.0 * budget.minutes
    while time.monotonic() < latest:
        ended = [judged for _, judged in ended_trials(study)]
        counted = sum(judged.status is not Status.REFUSED for judged in ended)
        if counted + running_count(study) >= budget.trials:
            break
        _expect_some(ended, counted, budget)
        share = counted / budget.trials
        monitor(share, "proposing")
        trial, values = proposals.ask()
        judged = _judged(evaluator, study, trial, values, _at(monitor, share))
        losses = _losses(problem, judged, [base, *ended])
        note(study, trial, problem, judged, losses)
        pressed = "press" in {**judged.ran, **judged.found}
        proposals.settled(values, pressed=pressed)
        counted += judged.status is not Status.REFUSED
        on_trial(_told(study, trial, judged, counted, budget))
    return study


def _base(study: Any, evaluator: Evaluator, monitor: Monitor) -> Judged:
    """The base as it is judged; once for all processes and runs."""
    known = study.user_attrs.get(BASE)
    if known is not None:
        return from_journal(known)
    judged = evaluator.judge_base(monitor)
    study.set_user_attr(BASE, judged.table)
    return judged


def _grouped(problem: Problem, evaluator: Evaluator) -> frozenset[str]:
    """Fields that trials share in groups: those of the press, where there are others too."""
    outer = evaluator.of_the_press
    return outer if len(outer) < len(problem.vary) else frozenset()


def _at(monitor: Monitor, share: float) -> Monitor:
    """Progress within a trial moves no bar: its note tells."""
    return lambda fraction, note="": monitor(share, note)


def _expect_some(ended: Sequence[Judged], counted: int, budget: Budget) -> None:
    refused = len(ended) - counted
    if refused > MOST_REFUSED * max(1, min(counted + 1, budget.trials)):
        last = next(judged.reason for judged in reversed(ended) if judged.reason)
        raise SearchError(
            f"{refused} designs were refused and {counted} computed; the last one because {last}",
            hint="make ranges narrower, link fields that must move together, or loosen a limit",
            at="search",
        )


def _judged(
    evaluator: Evaluator, study: Any, trial: Any, values: Mapping[str, Value], monitor: Monitor
) -> Judged:
    """What comes of a trial; one that is stopped or meets a bug is noted as failed."""
    from optuna.trial import TrialState

    try:
        return evaluator.judge(values, monitor)
    except (Cancelled, KeyboardInterrupt, Exception):
        study.tell(trial, state=TrialState.FAIL)
        raise


def note(study: Any, trial: Any, problem: Problem, judged: Judged, losses: Sequence[float]) -> None:
    """Write a trial that has ended into the journal."""
    trial.set_user_attr(JUDGED, judged.table)
    trial.set_constraint(REFUSED, -1.0 if judged.status is Status.JUDGED else 1.0)
    for limit in problem.limits:
        found = judged.figures.get(limit.figure)
        trial.set_constraint(_named(limit), 0.0 if found is None else limit.excess(found))
    signs = [1.0 if direction.name == "MINIMIZE" else -1.0 for direction in study.directions]
    study.tell(trial, [sign * loss for sign, loss in zip(signs, losses, strict=True)])


def _named(limit: Any) -> str:
    return f"{limit.figure} {limit.words}"


def _losses(problem: Problem, judged: Judged, before: Sequence[Judged]) -> list[float]:
    """What is minimised, goal by goal; where the figure is not known the worst so far."""
    found = []
    for goal in problem.goals:
        own = judged.figures.get(goal.figure)
        if own is not None:
            found.append(goal.loss(own))
            continue
        known = [
            goal.loss(one.figures[goal.figure]) for one in before if goal.figure in one.figures
        ]
        found.append(max(known, default=0.0))
    return found


def _told(study: Any, trial: Any, judged: Judged, counted: int, budget: Budget) -> Told:
    return Told(
        number=trial.number,
        sampler=trial.user_attrs[SAMPLER],
        judged=judged,
        counted=counted,
        wanted=budget.trials,
        study=study,
    )
