"""Fronts that samplers found on a model, evaluated for real.

An optimiser finds where a model is too kind as well as where designs are good. So designs of each
front are evaluated as trials are, of each at most as many, and the hypervolume of what they are in
truth stands beside that of the model. The best of ours is evaluated once more by the base's own
settings, and so is the base: that is what the search gains over the preset.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from workbench.core.base.monitor import silent
from workbench.proof.validation.search.duel import Scale, Step, losses_in, losses_of
from workbench.proof.validation.search.samplers import OURS
from workbench.proof.validation.search.samples import Sample, mend, read_samples, write_sample
from workbench.search.front import unbeaten
from workbench.search.journal import problem_digest
from workbench.search.judged import Evaluator, Judged, Status
from workbench.search.problem import Goal, Problem, Value
from workbench.system.terminal import complain

MOST = 10
"""Designs of a front that are evaluated; our choice, as a design takes a processor's seconds."""
Runs = Mapping[tuple[str, int], Sequence[Step]]
"""Proposals by sampler and seed."""


class Truth:
    """Evaluates designs and keeps them as lines of a file, so that none is evaluated twice."""

    def __init__(self, problem: Problem, evaluator: Evaluator, path: Path) -> None:
        self.evaluator, self.path = evaluator, path
        self._of = problem_digest(problem)
        mend(path)
        self._known = {_key(one.values): one for one in read_samples(path, self._of).values()}
        self._asked: set[str] = set()

    def judge(self, values: Mapping[str, Value]) -> Judged:
        """What comes of a design in truth; of no values, of the base."""
        key = _key(values)
        self._asked.add(key)
        if key not in self._known:
            base = not values
            judged = (
                self.evaluator.judge_base(silent) if base else self.evaluator.judge(values, silent)
            )
            sample = Sample(number=len(self._known), values=values, judged=judged, stage_s={})
            write_sample(self.path, sample, self._of)
            self._known[key] = sample
            complain(f"{self.path.stem} {sample.number}: {judged.status} {judged.reason}")
        return self._known[key].judged

    @property
    def asked(self) -> list[Sample]:
        """Designs that somebody asked for since this began, the base not among them."""
        return [self._known[key] for key in sorted(self._asked) if self._known[key].values]


def confirmed(
    problem: Problem, runs: Runs, scale: Scale, truth: Truth, final: Truth
) -> dict[str, Any]:
    """What the fronts are in truth, as the record holds it.

    Args:
        problem: What was looked for.
        runs: What was proposed.
        scale: Of the hypervolume.
        truth: Evaluates designs by the settings of trials.
        final: The same by the base's own settings.
    """
    found, off, gains = [], [], []
    for (sampler, seed), steps in runs.items():
        front = chosen(front_steps(steps), scale)
        real = [truth.judge(step.values) for step in front]
        losses = [losses_of(problem, each) for each in real]
        off += [_off(step, own) for step, own in zip(front, losses, strict=True) if own is not None]
        share = scale.share([own for own in losses if own is not None])
        found.append({"sampler": sampler, "seed": seed, "designs": len(front), "share": share})
        if sampler == OURS:
            gains.append({"seed": seed, **best_gain(problem, front, truth, final)})
    return {"true": found, "front_error": float(np.median(off)) if off else None, "gains": gains}


def front_steps(steps: Sequence[Step]) -> list[Step]:
    """Allowed proposals that no other one beats."""
    allowed = [step for step in steps if step.losses is not None]
    best = unbeaten(np.array(losses_in(steps)))
    return [step for step, each in zip(allowed, best, strict=True) if each]


def chosen(front: Sequence[Step], scale: Scale, most: int = MOST) -> list[Step]:
    """Designs of a front that dominate most together, each added where it adds most."""
    taken: list[Step] = []
    while len(taken) < min(most, len(front)):
        rest = [step for step in front if step not in taken]
        taken.append(max(rest, key=lambda step: scale.share(losses_in([*taken, step]))))
    return taken


def best_gain(
    problem: Problem, front: Sequence[Step], truth: Truth, final: Truth
) -> dict[str, float | None]:
    """By how much the best design of a front beats the base in every goal [1].

    The best is that whose least gain is the most by the settings of trials; by the base's own
    settings it is then judged once more.
    """
    base = truth.judge({})
    values = [step.values for step in front]
    found = [(gain(problem, truth.judge(one), base), one) for one in values]
    known = [(share, one) for share, one in found if share is not None]
    if not known:
        return {"draft": None, "own": None}
    draft, best = max(known, key=lambda pair: pair[0])
    return {"draft": draft, "own": gain(problem, final.judge(best), final.judge({}))}


def gain(problem: Problem, judged: Judged, base: Judged) -> float | None:
    """The least gain over the base among the goals [1]: .2 is a fifth more, or less where that is
    wanted; None of a design that is not allowed."""
    if judged.status is not Status.JUDGED or losses_of(problem, judged) is None:
        return None
    return min(
        _gain(goal, judged.figures[goal.figure], base.figures[goal.figure])
        for goal in problem.goals
    )


def _gain(goal: Goal, value: float, before: float) -> float:
    better, worse = goal.loss(before) - goal.loss(value), abs(before)
    return better / worse if worse else 0.0


def _off(step: Step, real: Sequence[float]) -> float:
    """The largest error of the model among the goals, over the truth."""
    told = np.array(step.losses, float)
    return float((np.abs(told - real) / np.maximum(np.abs(real), 1e-12)).max())


def _key(values: Mapping[str, Value]) -> str:
    return json.dumps(values, sort_keys=True)
