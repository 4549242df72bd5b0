"""The default search beside Sobol, random and TPE on the response of real problems.

    python -m workbench.proof.validation.search.contest FOLDER

reads the designs that `response` evaluated into FOLDER and makes the record: three seeds of each
sampler, 60 trials, on a model of them (`model`); the fronts that were found evaluated for real
(`confirmed`); the same again on a model that knows those too, which is what counts. Hypervolume is
measured between the best and the worst allowed design of those that were spread, and told over that
of them all. *Equal minutes* are those in which 60 designs are judged one after the other, with
nothing thought: thinking costs trials, sharing presses gives some.
"""

from __future__ import annotations

import argparse
import dataclasses
import os
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from workbench.project.project import Project
from workbench.proof.validation.search.confirmed import Truth, confirmed
from workbench.proof.validation.search.duel import (
    Scale,
    Step,
    losses_in,
    losses_of,
    scale_of,
    searched,
    with_seed,
    within_time,
    within_trials,
)
from workbench.proof.validation.search.model import Model
from workbench.proof.validation.search.problems import TEXTS, problem_of
from workbench.proof.validation.search.samplers import SAMPLERS
from workbench.proof.validation.search.samples import BASE, Sample, read_samples
from workbench.search.evaluator import DesignEvaluator
from workbench.search.journal import problem_digest
from workbench.search.problem import Problem
from workbench.system.record import ROOT, Record
from workbench.system.terminal import complain

SEEDS = (1, 2, 3)
TRIALS = 60
EACH = 10
"""Trials between two points of a line that is kept."""
PRESETS = ROOT / "designs" / "presets"
RECORD = Record(
    path=Path(__file__).with_name("contest.json"),
    command="python -m workbench.proof.validation.search.contest FOLDER",
    sources=("workbench.proof.validation.search.contest",),
    # What was evaluated is data: solvers of another day do not make it stale; other problems,
    # models, samplers, loops or scores do.
    apart=(
        "sim",
        "geometry",
        "designs",
        "workbench.calibration",
        "workbench.core",
        "workbench.learning",
        "workbench.pipeline",
        "workbench.planning",
        "workbench.project",
        "workbench.report",
        "workbench.system",
        "workbench.variants",
        "workbench.view",
        "workbench.cluster",
    ),
    files=(PRESETS / "geltip.toml", PRESETS / "pad.toml"),
)


def contest(model: Model, trials: int = TRIALS, seeds: Sequence[int] = SEEDS) -> dict[str, Any]:
    """Runs of all samplers, and what they are measured by, as the record holds them.

    Args:
        model: Judges.
        trials: Of each run.
        seeds: Of the runs.

    Raises:
        SearchError: If nearly every proposal of one is refused.
    """
    scale = scale_of(np.array(known_losses(model.problem, model.samples)))
    runs, steps = [], {}
    for seed in seeds:
        for sampler in SAMPLERS:
            model.forget()
            spent_s = trials * model.cost.judged_s
            found = searched(
                with_seed(model.problem, seed), model, sampler, trials=trials, spent_s=spent_s
            )
            own = run_figures(found, scale, trials=trials, spent_s=spent_s)
            runs.append({"sampler": sampler, "seed": seed, **own})
            steps[sampler, seed] = within_trials(found, trials)
            complain(f"{sampler} {seed}: {own['at_trials']:.3f} of the designs' hypervolume")
    every = [loss for found in steps.values() for loss in losses_in(found)]
    return {
        "designs": len(model.samples),
        "added": len(model.known) - len(model.samples),
        "trials": trials,
        "cost_s": dataclasses.asdict(model.cost),
        "reference": scale.high.tolist(),
        "best": scale.low.tolist(),
        "errors": {name: each.error for name, each in model.surfaces.items()},
        "wrong_share": model.wrong_share,
        "refused_share": model.refused_share,
        "ceiling": scale.share([*every, *known_losses(model.problem, model.samples)]),
        "load": os.getloadavg()[0],
        "runs": runs,
        "steps": steps,
    }


def known_losses(problem: Problem, samples: Sequence[Sample]) -> list[tuple[float, ...]]:
    """Losses of designs that were evaluated and are allowed."""
    found = [losses_of(problem, one.judged) for one in samples]
    return [losses for losses in found if losses is not None]


def run_figures(
    steps: Sequence[Step], scale: Scale, *, trials: int, spent_s: float
) -> dict[str, Any]:
    """What one search reached.

    Args:
        steps: Its proposals.
        scale: Of the hypervolume.
        trials: The equal number.
        spent_s: The equal time [s].
    """
    own, in_time = within_trials(steps, trials), within_time(steps, spent_s)
    numbers = range(EACH, trials + 1, EACH)
    return {
        "at_trials": scale.share(losses_in(own)),
        "at_minutes": scale.share(losses_in(in_time)),
        "trials_in_minutes": sum(step.counts for step in in_time),
        "refused": sum(not step.counts for step in own),
        "thought_s": float(np.median([step.thought_s for step in own])),
        "line": [scale.share(losses_in(within_trials(steps, number))) for number in numbers],
    }


def figures(folder: Path) -> dict[str, Any]:
    """All problems of which there are designs, as the record holds them.

    Raises:
        DesignError: If there are too few designs, or of another problem.
        StoreError: If a file cannot be read.
    """
    project, found = Project(folder / "project"), {}
    for name in TEXTS:
        problem = problem_of(name, project)
        path = folder / f"{name}.jsonl"
        samples = list(read_samples(path, problem_digest(problem)).values())
        if not samples:
            continue
        complain(f"{name}: {len(samples) - 1} designs")
        judge = DesignEvaluator(problem, project)
        finally_judge = DesignEvaluator(problem, project, draft=False)
        truth = Truth(problem, judge, folder / f"{name}_fronts.jsonl")
        final = Truth(problem, finally_judge, folder / f"{name}_final.jsonl")
        found[name] = refined(Model(problem, samples, judge.of_the_press), truth, final)
    return {"problems": found}


def refined(model: Model, truth: Truth, final: Truth, trials: int = TRIALS) -> dict[str, Any]:
    """The contest on a model, and on one that knows the fronts of the first; that is told.

    Args:
        model: Of the designs that are spread over the box.
        truth: Evaluates designs by the settings of trials.
        final: The same by the base's own settings.
        trials: Of each run.
    """
    base = Sample(number=BASE, values={}, judged=model.base, stage_s={})
    first = _contest(model, truth, final, trials)
    again = Model(model.problem, [base, *model.samples], model.of_the_press, truth.asked)
    complain(f"again with {len(again.known) - len(again.samples)} designs of the fronts")
    kept = {name: first[name] for name in ("front_error", "errors", "true")}
    return {**_contest(again, truth, final, trials), "first": kept}


def _contest(model: Model, truth: Truth, final: Truth, trials: int) -> dict[str, Any]:
    results = contest(model, trials)
    scale = scale_of(np.array(known_losses(model.problem, model.samples)))
    real = confirmed(model.problem, results.pop("steps"), scale, truth, final)
    return {**results, **real}


def main(words: Sequence[str]) -> int:
    """Make the record."""
    from workbench.pipeline.devices import open_device

    parser = argparse.ArgumentParser(description="samplers compared on evaluated designs")
    parser.add_argument("folder", type=Path, help="where the designs are")
    parser.add_argument("--record", type=Path, default=RECORD.path, help="another file")
    options = parser.parse_args(words)
    open_device()
    record = dataclasses.replace(RECORD, path=options.record)
    record.make(lambda: figures(options.folder))
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
