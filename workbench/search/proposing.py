"""Who proposes the next design: a Gaussian process, and beside it always a Sobol sequence.

The first trials fill the box by Sobol, then every fourth does: what the process reaches beyond
that line is what it is worth, and the plot shows both. Source of the choice: two real problems, 60
trials and three seeds, in which it dominated more than Sobol, random and TPE did in every seed
(`workbench validate search`).
"""

from __future__ import annotations

import importlib.util
import warnings
from collections.abc import Mapping
from typing import Any, Protocol

from workbench.search.journal import BY, SAMPLER, own_mark
from workbench.search.problem import Problem, Value, Vary

SOBOL, GUIDED, TREE = "Sobol", "Gaussian process", "TPE"
STARTUP = 10
"""Trials by Sobol before the first that is guided."""
EVERY = 4
"""Of later trials so many are one by Sobol."""


class Asking(Protocol):
    """Who is asked for the next values by the loop of a search."""

    def ask(self) -> tuple[Any, dict[str, Value]]:
        """The next trial, an `optuna.Trial`, with its values by path."""
        ...

    def settled(self, values: Mapping[str, Value], *, pressed: bool) -> None:
        """Take in how a trial ended."""
        ...


class Proposals:
    """Asks a study for the next values."""

    def __init__(self, study: Any, problem: Problem, *, grouped: frozenset[str]) -> None:
        self.study = study
        self.vary = problem.vary
        self.grouped = grouped
        """Fields that follow from the trial before, within a group."""
        self.per_press = max(1, problem.per_press) if grouped else 1
        self._left = 0
        """Trials that still take the fields of the press from the group's first one."""
        self._held: dict[str, Value] = {}
        self.guided_by, self._samplers = _samplers(problem.seed, len(study.trials))

    def ask(self) -> tuple[Any, dict[str, Value]]:
        """The next trial, with its values by path.

        Trials that come in groups share the fields of the press: the group's first one is free.
        """
        count = len(self.study.trials)
        by_sobol = count < STARTUP or count % EVERY == EVERY - 1
        name = SOBOL if by_sobol else self.guided_by
        self.study.sampler = self._samplers[name]
        # Marked before it runs: proposing takes seconds, in which a process may be killed.
        held = self._held if self._left else {}
        self.study.enqueue_trial(held, user_attrs={BY: own_mark()})
        with warnings.catch_warnings():
            # Optuna says of each choice that Sobol's sequence does not know it.
            warnings.simplefilter("ignore")
            trial = self.study.ask()
            trial.set_user_attr(BY, own_mark())
            trial.set_user_attr(SAMPLER, name)
            values = {vary.path: suggested(trial, vary) for vary in self.vary}
        return trial, values

    def settled(self, values: Mapping[str, Value], *, pressed: bool) -> None:
        """Take in how a trial ended: only a press that there is can be shared."""
        if self._left:
            self._left -= 1
        elif pressed and self.per_press > 1:
            self._held = {path: values[path] for path in self.grouped}
            self._left = self.per_press - 1


def _samplers(seed: int, done: int) -> tuple[str, dict[str, Any]]:
    """The name of the guided sampler, and samplers by name.

    Sobol's sequence goes on where it was; what is drawn by chance must not begin anew.
    """
    from optuna.samplers import GPSampler, QMCSampler, RandomSampler, TPESampler

    plain = RandomSampler(seed=seed + done)
    with warnings.catch_warnings():
        # That it is new is no news to the designer.
        warnings.simplefilter("ignore")
        sobol = QMCSampler(
            scramble=True,
            seed=seed,
            independent_sampler=plain,
            warn_independent_sampling=False,
            warn_asynchronous_seeding=False,
        )
        tree = TPESampler(seed=seed + done, multivariate=True, n_startup_trials=STARTUP)
    able = all(importlib.util.find_spec(name) for name in ("scipy", "torch"))
    if not able:
        return TREE, {SOBOL: sobol, TREE: tree}
    process = GPSampler(seed=seed + done, n_startup_trials=STARTUP, warn_independent_sampling=False)
    return GUIDED, {SOBOL: sobol, GUIDED: process}


def suggested(trial: Any, vary: Vary) -> Value:
    """What a trial's sampler says of a field, rounded as a design file holds it."""
    if vary.choices:
        return trial.suggest_categorical(vary.path, vary.choices)
    if vary.whole:
        return trial.suggest_int(vary.path, round(vary.low), round(vary.high), log=vary.log)
    return vary.rounded(trial.suggest_float(vary.path, vary.low, vary.high, log=vary.log))
