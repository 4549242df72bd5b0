"""What the commands of training share: their options, reading of presses, words of scores."""

from __future__ import annotations

import argparse
import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.forces.network.spec import Target
from sim.forces.training.settings import PRESETS, Numbers, TrainingSettings
from workbench.cli.training_line import TrainingLine
from workbench.core.base.check import within
from workbench.system.terminal import complain, say

if TYPE_CHECKING:
    from workbench.learning.training.plan import Trained
    from workbench.learning.training.presses import Presses

CHANGES = {
    "epochs": (int, "epochs"),
    "batch": (int, "samples of a step"),
    "rate": (float, "largest learning rate"),
    "turns": (int, "orientations in which a whole skin is looked at"),
    "passes": (int, "how often an epoch goes through the samples"),
    "patience": (int, "epochs without a better validation before it stops; 0: never"),
}
"""Options that change a number of the preset."""


def add_data_options(sub: argparse.ArgumentParser) -> None:
    """Data, and where the result goes."""
    text = "data sets, of one membrane or of several, or a file of `train pack`"
    sub.add_argument("data", nargs="+", type=Path, metavar="DATA", help=text)
    text = "folder of the training; of `pack` the file, NAME.presses"
    sub.add_argument("--out", required=True, type=Path, metavar="PATH", help=text)
    sub.add_argument("--json", action="store_true", help="progress as one JSON object per line")


def add_training_options(sub: argparse.ArgumentParser, *, preset: str) -> None:
    """What is learned, and how."""
    sub.add_argument("--preset", choices=list(PRESETS), default=preset, help=f"default {preset}")
    targets = [target.value for target in Target]
    text = f"what is learned (default {Target.FORCE.value})"
    sub.add_argument("--target", choices=targets, default=Target.FORCE.value, help=text)
    sub.add_argument("--seed", type=int, default=0, metavar="S", help="another order and start")
    sub.add_argument("--cases", type=int, default=0, metavar="N", help="the first N training cases")
    numbers = [each.value for each in Numbers]
    text = f"arithmetic of the training (default {Numbers.AUTO.value})"
    sub.add_argument("--numbers", choices=numbers, default=Numbers.AUTO.value, help=text)
    text = "pause after the epoch in which so many minutes are over; the same command goes on"
    sub.add_argument("--minutes", type=float, default=0.0, metavar="M", help=text)
    for name, (kind, text) in CHANGES.items():
        text = f"{text} (default: the preset's)"
        sub.add_argument(f"--{name}", type=kind, metavar="N", help=text)


def chosen_settings(options: argparse.Namespace) -> TrainingSettings:
    """The preset with the options of the command line in it.

    Raises:
        DesignError: If a value is refused.
    """
    given = {name: getattr(options, name) for name in CHANGES}
    changes = {name: value for name, value in given.items() if value is not None}
    within(options.seed, 0, 2**31, what="seed", unit="", at="--seed")
    within(options.cases, 0, 10_000_000, what="cases", unit="", at="--cases")
    within(options.minutes, 0.0, 1e5, what="time", unit="minutes", at="--minutes")
    return dataclasses.replace(PRESETS[options.preset], **changes)


def train(options: argparse.Namespace, *, base: Path | None) -> int:
    """Train a network, or the decoder of one; returns the exit code."""
    from sim.forces.network.weights import load_weights
    from workbench.learning.training.learn import train as learn
    from workbench.learning.training.plan import Plan, Resources
    from workbench.pipeline.devices import torch_device

    plan = Plan(
        settings=chosen_settings(options),
        target=Target(options.target),
        seed=options.seed,
        cases=options.cases,
        base=None if base is None else load_weights(base),
        base_name="" if base is None else base.name,
    )
    presses = read(options, [plan.target])
    line = TrainingLine(as_json=options.json)
    try:
        done = learn(
            presses,
            plan,
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
    _say_done(done, plan.target, as_json=options.json)
    return 0


def read(options: argparse.Namespace, targets: Sequence[Target]) -> Presses:
    """Presses of the data sets that were named."""
    from workbench.learning.training.reading import read_presses
    from workbench.system.terminal import Progress

    show = Progress(as_json=options.json)
    return read_presses(
        options.data, targets=targets, tick=lambda fraction: show("read", fraction, "")
    )


def _say_done(done: Trained, target: Target, *, as_json: bool) -> None:
    if as_json:
        found = {
            "weights": str(done.weights),
            "finished": done.finished,
            "epochs": len(done.rows),
            "best_epoch": done.best_epoch,
            "scores": done.scores,
            "notes": list(done.notes),
        }
        say(json.dumps(found))
        return
    for note in done.notes:
        complain(f"note: {note}")
    state = "trained" if done.finished else "paused after"
    say(f"{state} {len(done.rows)} epochs, the best is {done.best_epoch}: {done.weights}")
    say(score_words(done.scores, target))


def score_words(scores: dict[str, Any], target: Target) -> str:
    """Scores of every part of the data, for people."""
    words = []
    for split, found in scores.items():
        nulls = [f"{found['mae'] / found['zero_mae']:.3f} of zero"] if found["zero_mae"] else []
        if found["mpm_mae"]:
            nulls.append(f"{found['mae'] / found['mpm_mae']:.3f} of the contact solver")
        words.append(f"{split} {found['mae']:.3g} {target.unit} ({', '.join(nulls)})")
    return "; ".join(words) or "no samples to measure on"
