"""Who proposes in a contest: the search as it ships, and samplers that propose alone.

Ours is `workbench.search.proposing.Proposals` through the loop of the product, as it is: a Gaussian
process, every fourth trial by Sobol, presses shared in groups. Sobol's sequence, random and TPE are
Optuna's, each alone from the first trial on, and press each design anew. TPE has the settings that
the search gives it where it takes the place of the process; its ten first trials are random.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from typing import Any

from workbench.search.journal import BY, SAMPLER, own_mark
from workbench.search.loop import Proposing
from workbench.search.problem import Problem, Value
from workbench.search.proposing import STARTUP, Asking, Proposals, suggested

OURS, SOBOL, RANDOM, TPE = "ours", "Sobol", "random", "TPE"
SAMPLERS = (OURS, SOBOL, RANDOM, TPE)


class Alone:
    """A sampler of Optuna's that proposes every trial."""

    def __init__(self, study: Any, problem: Problem, name: str) -> None:
        self.study, self.vary, self.name = study, problem.vary, name
        study.sampler = _sampler(name, problem.seed)

    def ask(self) -> tuple[Any, dict[str, Value]]:
        """The next trial, with its values by path."""
        with warnings.catch_warnings():
            # Optuna says of each choice that Sobol's sequence does not know it.
            warnings.simplefilter("ignore")
            trial = self.study.ask()
            trial.set_user_attr(BY, own_mark())
            trial.set_user_attr(SAMPLER, self.name)
            values = {vary.path: suggested(trial, vary) for vary in self.vary}
        return trial, values

    def settled(self, values: Mapping[str, Value], *, pressed: bool) -> None:
        """Nothing is shared between trials."""


def proposing(name: str) -> Proposing:
    """What makes the proposals of a sampler."""
    if name == OURS:
        return Proposals

    def alone(study: Any, problem: Problem, *, grouped: frozenset[str]) -> Asking:
        return Alone(study, problem, name)

    return alone


def _sampler(name: str, seed: int) -> Any:
    from optuna.samplers import QMCSampler, RandomSampler, TPESampler

    with warnings.catch_warnings():
        # That some of them are new is no news.
        warnings.simplefilter("ignore")
        if name == TPE:
            return TPESampler(seed=seed, multivariate=True, n_startup_trials=STARTUP)
        plain = RandomSampler(seed=seed)
        if name == RANDOM:
            return plain
        return QMCSampler(
            scramble=True,
            seed=seed,
            independent_sampler=plain,
            warn_independent_sampling=False,
            warn_asynchronous_seeding=False,
        )
