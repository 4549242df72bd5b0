"""`workbench train`: teach a network on data sets, tune it, and see what more data buy."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sim.forces.network.spec import Target
from sim.forces.training.settings import PRESETS, Numbers, TrainingSettings
from workbench.core.check import within
from workbench.core.errors import DesignError
from workbench.core.units import human_seconds
from workbench.project import Project
from workbench.terminal import complain, say

if TYPE_CHECKING:
    from workbench.training.plan import Told, Trained
    from workbench.training.presses import Presses

TOLD_S = 10.0
"""Time between two lines of progress where there is no terminal to rewrite one [s]."""
CHANGES = {
    "epochs": int,
    "batch": int,
    "rate": float,
    "turns": int,
    "passes": int,
    "patience": int,
}
"""Options that change a number of the preset."""


def add_train_commands(top: argparse.ArgumentParser, common: argparse.ArgumentParser) -> None:
    """The commands below `workbench train`."""
    subparsers = top.add_subparsers(dest="train_command", required=True)

    def command(handler: Any) -> argparse.ArgumentParser:
        text = (handler.__doc__ or "").splitlines()[0]
        sub = subparsers.add_parser(handler.__name__, help=text, description=text, parents=[common])
        sub.set_defaults(handler=handler)
        sub.add_argument("data", nargs="+", type=Path, metavar="DATA")
        sub.add_argument("--out", required=True, type=Path, metavar="PATH")
        sub.add_argument("--json", action="store_true")
        return sub

    _options(command(make), preset="small")
    tuning = command(tune)
    tuning.add_argument("--weights", required=True, type=Path, metavar="FILE")
    _options(tuning, preset="tune")
    learning = command(curve)
    _options(learning, preset="small")
    text = "shares of the training cases (default 0.125 0.25 0.5 1)"
    shares = (0.125, 0.25, 0.5, 1.0)
    learning.add_argument("--fractions", nargs="+", type=float, default=shares, help=text)
    packing = command(pack)
    text = "what shall be learned from it (default: all; stress takes the most room)"
    targets = [target.value for target in Target]
    packing.add_argument("--target", nargs="+", choices=targets, default=targets, help=text)


def _options(sub: argparse.ArgumentParser, *, preset: str) -> None:
    sub.add_argument("--preset", choices=list(PRESETS), default=preset, help=f"default {preset}")
    targets = [target.value for target in Target]
    sub.add_argument("--target", choices=targets, default=Target.FORCE.value)
    sub.add_argument("--seed", type=int, default=0, metavar="S")
    sub.add_argument("--cases", type=int, default=0, metavar="N", help="the first N training cases")
    numbers = [each.value for each in Numbers]
    sub.add_argument("--numbers", choices=numbers, default=Numbers.AUTO.value)
    text = "pause after the epoch in which so many minutes are over; the same command goes on"
    sub.add_argument("--minutes", type=float, default=0.0, metavar="M", help=text)
    for name, kind in CHANGES.items():
        sub.add_argument(f"--{name}", type=kind, metavar="N", help="in place of the preset's")


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


def make(options: argparse.Namespace, project: Project) -> int:
    """Train a network on a data set, or go on with a training that was stopped."""
    return _train(options, base=None)


def tune(options: argparse.Namespace, project: Project) -> int:
    """Train the decoder of weights on a few presses of another gel."""
    return _train(options, base=options.weights)


def _train(options: argparse.Namespace, *, base: Path | None) -> int:
    from sim.forces.network.weights import load_weights
    from workbench.devices import torch_device
    from workbench.training.learn import train
    from workbench.training.plan import Plan

    plan = Plan(
        settings=chosen_settings(options),
        target=Target(options.target),
        seed=options.seed,
        cases=options.cases,
        base=None if base is None else load_weights(base),
        base_name="" if base is None else base.name,
    )
    presses = _read(options, [plan.target])
    line = Line(as_json=options.json)
    try:
        done = train(
            presses,
            plan,
            options.out,
            device=torch_device(),
            numbers=Numbers(options.numbers),
            minutes=options.minutes,
            tell=line.tell,
            monitor=line.within,
        )
    finally:
        line.end()
    _say_done(done, plan.target, as_json=options.json)
    return 0


def curve(options: argparse.Namespace, project: Project) -> int:
    """Train on parts of a data set and draw what more cases buy."""
    from workbench.devices import torch_device
    from workbench.training.learning_curve import learning_curve
    from workbench.training.plan import Plan

    plan = Plan(settings=chosen_settings(options), target=Target(options.target), seed=options.seed)
    if options.cases:
        raise DesignError(
            f"--cases {options.cases} and --fractions both say how many cases",
            hint="leave --cases out",
            at="--cases",
        )
    presses = _read(options, [plan.target])
    line = Line(as_json=options.json)
    try:
        found = learning_curve(
            presses,
            plan,
            options.fractions,
            options.out,
            device=torch_device(),
            numbers=Numbers(options.numbers),
            minutes=options.minutes,
            tell=line.tell,
            monitor=line.within,
        )
    finally:
        line.end()
    if options.json:
        say(json.dumps(found))
        return 0
    for row in found["rows"]:
        say(f"{row['cases']:5} cases: " + _score_words(row["scores"], plan.target))
    return 0


def pack(options: argparse.Namespace, project: Project) -> int:
    """Pack data sets into one small file that training reads, for another machine."""
    from workbench.training.packed import SUFFIX, write_packed

    if options.out.suffix != SUFFIX:
        raise DesignError(
            f"{options.out} does not end in {SUFFIX}",
            hint=f"call it {options.out.with_suffix(SUFFIX)}",
            at="--out",
        )
    presses = _read(options, [Target(each) for each in options.target])
    write_packed(options.out, presses)
    size = options.out.stat().st_size
    cases = len({state.case for state in presses.states})
    if options.json:
        found = {"file": str(options.out), "bytes": size, "samples": len(presses.states)}
        say(json.dumps({**found, "cases": cases, "key": presses.key}))
    else:
        say(f"{options.out}: {len(presses.states)} samples of {cases} cases, {size / 1e6:.1f} MB")
    return 0


def _read(options: argparse.Namespace, targets: Sequence[Target]) -> Presses:
    from workbench.terminal import Progress
    from workbench.training.reading import read_presses

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
    say(_score_words(done.scores, target))


def _score_words(scores: dict[str, Any], target: Target) -> str:
    words = []
    for split, found in scores.items():
        nulls = [f"{found['mae'] / found['zero_mae']:.3f} of zero"] if found["zero_mae"] else []
        if found["mpm_mae"]:
            nulls.append(f"{found['mae'] / found['mpm_mae']:.3f} of the contact solver")
        words.append(f"{split} {found['mae']:.3g} {target.unit} ({', '.join(nulls)})")
    return "; ".join(words) or "no samples to measure on"


class Line:
    """Progress of a training: one line that is rewritten, or one every few seconds."""

    def __init__(self, *, as_json: bool) -> None:
        self.as_json = as_json
        self.rewrites = not as_json and sys.stderr.isatty()
        self._said_s = 0.0
        self._shown = ""
        self._notes = 0

    def tell(self, told: Told) -> None:
        """Show an epoch that ended."""
        for note in told.notes[self._notes :]:
            self.end()
            complain(f"note: {note}")
        self._notes = len(told.notes)
        if self.as_json:
            say(json.dumps({"stage": "train", "eta_s": told.eta_s, **told.row}))
            return
        row = told.row
        line = f"epoch {row['epoch']} of {told.epochs}: loss {row['train_loss']:.3f}"
        if row["validation_mae"] is not None:
            line += f", validation {row['validation_mae']:.3g} (zero {row['zero_mae']:.3g}"
            line += f", contact solver {row['mpm_mae']:.3g})" if row["mpm_mae"] else ")"
        line += f", {human_seconds(told.eta_s)} left"
        now, last = time.monotonic(), row["epoch"] == told.epochs
        if self.rewrites:
            complain(f"\r\x1b[K{line}", end="")
            self._shown = line
        elif now - self._said_s >= TOLD_S or last:
            self._said_s = now
            complain(line)

    def within(self, fraction: float, note: str = "") -> None:
        """Show how far an epoch is."""
        if self.rewrites and time.monotonic() - self._said_s > 1.0:
            self._said_s = time.monotonic()
            complain(f"\r\x1b[K{self._shown or 'epoch 1'} ({100 * fraction:.0f} %)", end="")

    def end(self) -> None:
        """Leave the line that is rewritten."""
        if self.rewrites and self._shown:
            complain("")
            self._shown = ""
