"""`workbench train curve`: what more cases buy."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from sim.forces.network.spec import Target
from sim.forces.training.settings import Numbers
from workbench.core.base.errors import DesignError
from workbench.project.project import Project
from workbench.system.terminal import say

if TYPE_CHECKING:
    pass
from workbench.cli.command import Command
from workbench.cli.training import (
    add_data_options,
    add_training_options,
    chosen_settings,
    read,
    score_words,
)
from workbench.cli.training_line import TrainingLine


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    add_data_options(sub)
    add_training_options(sub, preset="small")
    text = "shares of the training cases (default 0.125 0.25 0.5 1)"
    shares = (0.125, 0.25, 0.5, 1.0)
    sub.add_argument("--fractions", nargs="+", type=float, default=shares, help=text)


def run(options: argparse.Namespace, project: Project) -> int:
    """Train on parts of a data set and draw what more cases buy."""
    from workbench.learning.training.learning_curve import learning_curve
    from workbench.learning.training.plan import Plan, Resources
    from workbench.pipeline.devices import torch_device

    plan = Plan(settings=chosen_settings(options), target=Target(options.target), seed=options.seed)
    if options.cases:
        raise DesignError(
            f"--cases {options.cases} and --fractions both say how many cases",
            hint="leave --cases out",
            at="--cases",
        )
    presses = read(options, [plan.target])
    line = TrainingLine(as_json=options.json)
    try:
        found = learning_curve(
            presses,
            plan,
            options.fractions,
            options.out,
            resources=Resources(
                device=torch_device(),
                numbers=Numbers(options.numbers),
                minutes=options.minutes,
            ),
            tell=line.tell,
            monitor=line.within,
        )
    finally:
        line.end()
    if options.json:
        say(json.dumps(found))
        return 0
    for row in found["rows"]:
        say(f"{row['cases']:5} cases: " + score_words(row["scores"], plan.target))
    return 0


COMMAND = Command(place=3, run=run, options=options)
