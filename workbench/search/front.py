"""The best of a search: designs that none beats, how fast they came, and what mattered."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from workbench.search.journal import BASE, SAMPLER, ended_trials
from workbench.search.judged import Judged, Status, from_journal
from workbench.search.problem import Problem
from workbench.search.proposing import SOBOL

FEWEST_FOR_IMPORTANCE = 12
"""Trials below which a share of variance says nothing; our choice."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Trial:
    """One that has ended."""

    number: int
    sampler: str
    judged: Judged
    losses: tuple[float, ...]
    """Of the goals; () where a figure is not known."""
    allowed: bool
    """Whether every figure is known and every limit kept."""


@dataclass(frozen=True, kw_only=True, slots=True)
class Found:
    """A search as it stands."""

    problem: Problem
    trials: tuple[Trial, ...]
    front: tuple[Trial, ...]
    """Allowed trials that none beats in every goal, the best of the first goal first."""
    base: Judged | None

    @property
    def counted(self) -> int:
        """Trials that were not refused."""
        return sum(trial.judged.status is not Status.REFUSED for trial in self.trials)


def found_of(problem: Problem, study: Any) -> Found:
    """What a study holds."""
    trials = tuple(
        _trial(problem, trial.number, trial.user_attrs[SAMPLER], judged)
        for trial, judged in ended_trials(study)
    )
    base = study.user_attrs.get(BASE)
    return Found(
        problem=problem,
        trials=trials,
        front=tuple(sorted(front_of(trials), key=lambda trial: trial.losses)),
        base=None if base is None else from_journal(base),
    )


def _trial(problem: Problem, number: int, sampler: str, judged: Judged) -> Trial:
    figures = judged.figures
    whole = judged.status is Status.JUDGED and all(g.figure in figures for g in problem.goals)
    losses = tuple(goal.loss(figures[goal.figure]) for goal in problem.goals) if whole else ()
    return Trial(
        number=number,
        sampler=sampler,
        judged=judged,
        losses=losses,
        allowed=whole and keeps_limits(problem, figures),
    )


def keeps_limits(problem: Problem, figures: Mapping[str, float]) -> bool:
    """Whether every limit's figure is known and within."""
    return all(
        limit.figure in figures and limit.excess(figures[limit.figure]) <= 0.0
        for limit in problem.limits
    )


def front_of(trials: Sequence[Trial]) -> list[Trial]:
    """Allowed trials that no other beats; of equal ones the first."""
    allowed = [trial for trial in trials if trial.allowed]
    best = unbeaten(np.array([trial.losses for trial in allowed]))
    kept = [trial for trial, each in zip(allowed, best, strict=True) if each]
    return list({trial.losses: trial for trial in reversed(kept)}.values())


def unbeaten(losses: np.ndarray) -> np.ndarray:
    """Which points (N, K) no other beats, shape (N,): is as good in all goals, better in one."""
    return np.array(
        [not ((losses <= own).all(axis=1) & (losses < own).any(axis=1)).any() for own in losses],
        dtype=bool,
    )


def hypervolume(losses: np.ndarray, reference: np.ndarray) -> float:
    """Volume that points (N, K) dominate up to a reference (K,): by slices of the last goal.

    Source: the definition (Zitzler and Thiele 1998), here by recursion, for few goals and points.
    """
    inside = losses[(losses < reference).all(axis=1)]
    if not len(inside):
        return 0.0
    if inside.shape[1] == 1:
        return float(reference[0] - inside.min())
    order = np.argsort(inside[:, -1])
    inside = inside[order]
    ends = np.append(inside[1:, -1], reference[-1])
    heights = ends - inside[:, -1]
    return sum(
        float(height) * hypervolume(inside[: k + 1, :-1], reference[:-1])
        for k, height in enumerate(heights)
        if height > 0.0
    )


def progress_lines(found: Found) -> dict[str, list[float]]:
    """Hypervolume after each trial of a kind, over that of the whole front: guided, and Sobol.

    Each goal is scaled by the span of the trials; refused ones stand still. Guided trials have seen
    those by Sobol, so their line may only be read as what the two together reach.
    """
    allowed = [trial for trial in found.trials if trial.allowed]
    if not allowed:
        return {}
    losses = np.array([trial.losses for trial in allowed])
    low, high = losses.min(axis=0), losses.max(axis=0)
    span = np.where(high > low, high - low, 1.0)
    reference = np.full(losses.shape[1], 1.05)
    whole = hypervolume((losses - low) / span, reference)
    lines = {}
    for name in dict.fromkeys(trial.sampler for trial in found.trials):
        points: list[tuple[float, ...]] = []
        line = []
        for trial in found.trials:
            if trial.sampler == name and trial.judged.status is not Status.REFUSED:
                points += [trial.losses] if trial.allowed else []
                scaled = (np.array(points).reshape(-1, losses.shape[1]) - low) / span
                line.append(hypervolume(scaled, reference) / whole)
        lines[name] = line
    return {name: lines[name] for name in sorted(lines, key=lambda name: name != SOBOL)}


def importance(found: Found, study: Any) -> dict[str, dict[str, float]]:
    """Share of each varied field in how a goal's figure varies, by goal; {} of few trials.

    Source: functional ANOVA (Hutter and others, ICML 2014) as Optuna has it, where scikit-learn is
    installed, else PED-ANOVA (Watanabe and others, IJCAI 2023).
    """
    import warnings

    from optuna.importance import get_param_importances

    if sum(bool(trial.losses) for trial in found.trials) < FEWEST_FOR_IMPORTANCE:
        return {}
    known = _only(study, {trial.number for trial in found.trials if trial.losses})
    shares = {}
    for place, goal in enumerate(found.problem.goals):

        def value(trial: Any, place: int = place) -> float:
            return trial.values[place]

        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            each = get_param_importances(known, evaluator=_anova(found.problem.seed), target=value)
        shares[goal.figure] = {name: float(share) for name, share in each.items()}
    return shares


def _only(study: Any, numbers: set[int]) -> Any:
    """A study in memory with only these trials: imputed losses tell nothing of a field."""
    import optuna

    kept = optuna.create_study(directions=[d.name.lower() for d in study.directions])
    for trial in study.get_trials(deepcopy=False):
        if trial.number in numbers:
            kept.add_trial(trial)
    return kept


def _anova(seed: int) -> Any:
    import importlib.util

    from optuna.importance import FanovaImportanceEvaluator, PedAnovaImportanceEvaluator

    if importlib.util.find_spec("sklearn"):
        return FanovaImportanceEvaluator(seed=seed)
    return PedAnovaImportanceEvaluator()
