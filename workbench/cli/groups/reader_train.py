"""`workbench reader train`: make presses and views of a design, and train its reader on them."""

from __future__ import annotations

import argparse
import json
import sys
from pathlib import Path
from typing import Any

from sim.reading.network.reader_file import SUFFIX, ReaderFile
from sim.reading.network.spec import SIZES
from workbench.cli.command import Command
from workbench.cli.options import DESIGN
from workbench.cli.press_arguments import add_set_option
from workbench.core.base.check import within
from workbench.core.design.design import SensorDesign
from workbench.project.project import Project
from workbench.system.processes import cores
from workbench.system.terminal import Progress, complain, say

COUNTS = {
    "epochs": "times that all views are learned from, at most; 0: as time allows",
    "presses": "presses that are solved, at most; 0: what suits the device",
    "views": "rendered views, at most; 0: what suits the device",
    "looks": "built sensors, each with light and camera off by chance; 0: what suits the device",
    "batch": "presses side by side; 0: 1, on each GPU 128",
}
"""Options that are numbers, 0 where they are left out."""
NOTHING = "nothing"
"""What `--from` begins from where no reader is wanted."""
MOST = 1_000_000
MOST_LOOKS = 97
"""Two more judge."""


def options(sub: argparse.ArgumentParser) -> None:
    """What may be typed behind it."""
    sub.add_argument("design", metavar="NAME|FILE", help=DESIGN)
    text = f"file of the reader, NAME{SUFFIX} (default: in the project, where `read` finds it)"
    sub.add_argument("--out", type=Path, metavar="FILE", help=text)
    text = (
        "reader to begin from, or `nothing` (default: for a calibrated design the reader of that "
        "design, else nothing)"
    )
    sub.add_argument("--from", dest="start", metavar="FILE", help=text)
    text = "size of the network (default: that of --from, else small, on a GPU full)"
    sub.add_argument("--size", choices=list(SIZES), default="", help=text)
    text = "time for presses, views and learning together (default 50)"
    sub.add_argument("--minutes", type=float, default=50.0, metavar="M", help=text)
    for name, text in COUNTS.items():
        sub.add_argument(f"--{name}", type=int, default=0, metavar="N", help=text)
    text = "processes that make data (default: one for each processor)"
    sub.add_argument("--jobs", type=int, default=cores(), metavar="N", help=text)
    sub.add_argument("--seed", type=int, default=0, metavar="S", help="other presses and start")
    add_set_option(sub)
    sub.add_argument("--json", action="store_true", help="progress and scores as JSON lines")


def run(options: argparse.Namespace, project: Project) -> int:
    """Train the learned reader of a design, or go on with a training that was stopped."""
    from workbench.edit.typed_fields import with_typed
    from workbench.learning.readers.beginning import usual_path
    from workbench.learning.readers.train_reader import ReaderPlan, train_reader
    from workbench.project.named_designs import load_design

    within(options.minutes, 0.05, 1e5, what="time", unit="minutes", at="--minutes")
    within(options.jobs, 1, 1024, what="processes", unit="", at="--jobs")
    within(options.seed, 0, 2**30, what="seed", unit="", at="--seed")
    for name in COUNTS:
        most = MOST_LOOKS if name == "looks" else MOST
        within(getattr(options, name), 0, most, what=name, unit="", at=f"--{name}")
    design = with_typed(load_design(options.design, project=project), options.set)
    printer = Progress(as_json=options.json)
    done = train_reader(
        design,
        options.out or usual_path(design, project),
        project,
        ReaderPlan(
            size=options.size,
            minutes=options.minutes,
            jobs=options.jobs,
            seed=options.seed,
            start=_start(options, design, project),
            **{name: getattr(options, name) for name in COUNTS},
        ),
        tell=lambda row: _say_row(row, as_json=options.json),
        monitor=printer,
    )
    if options.json:
        told = {"reader": str(done.path), "scores": done.scores}
        say(json.dumps(told if done.before is None else {**told, "before": done.before}))
    else:
        if done.before is not None:
            say(f"the reader it began from: {score_words(done.before)}")
        say(f"reader {done.path}: {score_words(done.scores)}")
    return 0


def _start(
    options: argparse.Namespace, design: SensorDesign, project: Project
) -> ReaderFile | None:
    """The reader that the training begins from."""
    from workbench.learning.readers.beginning import named_start, usual_start

    if options.start == NOTHING:
        return None
    if options.start is not None:
        return named_start(Path(options.start), design, options.size)
    start = usual_start(design, project, options.size)
    if start is not None and not options.json:
        complain(
            f"begins from the reader of {start.design} as it was drawn: --from nothing does not"
        )
    return start


def score_words(scores: dict[str, Any]) -> str:
    """Scores on a built sensor and places that nothing was learned from, for people."""
    return (
        f"depth off by {scores['depth_mae_mm']:.3f} mm where skin moved "
        f"(zero depth: {scores['zero_mae_mm']:.3f}), contact IoU {scores['contact_iou']:.2f}, "
        f"force off by {100.0 * scores['force_error']:.0f} %, "
        f"{100.0 * scores['within_sigma']:.0f} % within one standard deviation"
    )


def _say_row(row: dict[str, Any], *, as_json: bool) -> None:
    if as_json:
        say(json.dumps({"stage": "learn", **row}))
        return
    start = "\r\x1b[K" if sys.stderr.isatty() else ""
    complain(
        f"{start}{row['minutes']:.1f} minutes, {row['epochs']:.1f} epochs: loss {row['loss']:.4f}, "
        f"validation {row['validation_mae_mm']:.3f} mm (zero {row['zero_mae_mm']:.3f}), "
        f"force {100.0 * row['force_error']:.0f} %"
    )


COMMAND = Command(place=1, run=run, options=options)
