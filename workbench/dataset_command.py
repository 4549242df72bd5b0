"""`workbench dataset`: make, check and show data sets of presses for learning."""

from __future__ import annotations

import argparse
import dataclasses
import json
import sys
import time
from pathlib import Path
from typing import Any

from workbench.core.errors import DesignError
from workbench.core.fem import DRAFT_MM
from workbench.core.units import human_seconds
from workbench.dataset.recipe import RECIPES, Recipe, Solvers, load_recipe
from workbench.press_arguments import add_set_option
from workbench.press_options import typed_numbers
from workbench.project import Project
from workbench.terminal import Progress, complain, say
from workbench.typed_fields import with_typed

TOLD_S = 10.0
"""Time between two lines of progress where there is no terminal to rewrite one [s]."""


def add_dataset_commands(top: argparse.ArgumentParser, common: argparse.ArgumentParser) -> None:
    """The commands below `workbench dataset`."""
    subparsers = top.add_subparsers(dest="dataset_command", required=True)

    def command(handler: Any) -> argparse.ArgumentParser:
        text = (handler.__doc__ or "").splitlines()[0]
        sub = subparsers.add_parser(handler.__name__, help=text, description=text, parents=[common])
        sub.set_defaults(handler=handler)
        sub.add_argument("--json", action="store_true")
        return sub

    _make_options(command(make))
    for handler in (status, preview, repair):
        command(handler).add_argument("folder", type=Path, metavar="DIR")
    command(recipes)


def _make_options(sub: argparse.ArgumentParser) -> None:
    sub.add_argument("recipe", metavar="NAME|FILE", help="see `workbench dataset recipes`")
    sub.add_argument("--out", required=True, type=Path, metavar="DIR")
    sub.add_argument("--cases", type=int, metavar="N", help="the first N cases; 0: all")
    sub.add_argument("--jobs", type=int, default=1, metavar="N", help="processes (default 1)")
    text = f"hexahedra of {DRAFT_MM} mm: about 10 %% too stiff, ten times faster"
    sub.add_argument("--draft", action="store_true", help=text)
    text = "another Young's modulus than the recipe's; cases and split stay the same"
    sub.add_argument("--young", type=float, metavar="MPA", help=text)
    sub.add_argument("--solver", choices=[solver.value for solver in Solvers])
    sub.add_argument("--no-images", action="store_true", help="fields and forces only")
    add_set_option(sub)
    text = "turn every object about the fixed X, then Y, then Z before it is pressed"
    sub.add_argument("--turn-deg", metavar="X,Y,Z", help=text)
    sub.add_argument("--seed", type=int, metavar="S", help="of the order of cases and the split")
    text = "only say what there is to do and what it costs by the cases finished in DIR"
    sub.add_argument("--estimate", action="store_true", help=text)


def chosen_recipe(options: argparse.Namespace, project: Project) -> Recipe:
    """The recipe with the options of the command line in it.

    Raises:
        DesignError: If there is none of that name, or a value is refused.
    """
    changes: dict[str, Any] = {
        "cases": options.cases,
        "seed": options.seed,
        "solvers": options.solver and Solvers(options.solver),
        "hex_mm": DRAFT_MM if options.draft else None,
        "images": False if options.no_images else None,
    }
    if options.turn_deg is not None:
        changes["turn_deg"] = typed_numbers(options.turn_deg, at="--turn-deg")
    given = {name: value for name, value in changes.items() if value is not None}
    recipe = dataclasses.replace(load_recipe(options.recipe, project), **given)
    if options.young is not None:
        design = recipe.design.replace("material.young_MPa", options.young)
        recipe = dataclasses.replace(recipe, design=design)
    return dataclasses.replace(recipe, design=with_typed(recipe.design, options.set))


def make(options: argparse.Namespace, project: Project) -> int:
    """Make a data set, or the rest of one that was stopped."""
    if options.jobs < 1:
        raise DesignError(
            f"{options.jobs} processes make nothing", hint="use --jobs 1 or more", at="--jobs"
        )
    recipe = chosen_recipe(options, project)
    if options.estimate:
        return _say_estimate(recipe, options)
    from workbench.dataset.collect import make as make_it

    printer = Progress(as_json=options.json)
    line = _Line(as_json=options.json)
    started = time.monotonic()
    try:
        data = make_it(
            recipe, options.out, project, jobs=options.jobs, tell=line.tell, monitor=printer
        )
    finally:
        line.end()
    counts = data.counts()
    if options.json:
        say(json.dumps({"folder": str(options.out), "key": data.key, **counts}))
    else:
        say(
            f"{counts['samples_done']} of {counts['samples']} samples, "
            f"{counts['cases_done']} of {counts['cases']} cases complete, "
            f"{counts['cases_failed']} failed, after {human_seconds(time.monotonic() - started)}; "
            f"open {options.out / 'card.md'}"
        )
    return 0 if counts["cases_done"] == counts["cases"] else 3


def _say_estimate(recipe: Recipe, options: argparse.Namespace) -> int:
    """What there is to do, and what it costs as far as finished cases tell."""
    from workbench.dataset.cases import deal, positions_of
    from workbench.dataset.estimate import estimate, estimate_text
    from workbench.dataset.folder import FAILED, MANIFEST, TIMES, DataSet
    from workbench.dataset.positions import Pattern, Position
    from workbench.dataset.rows import read_rows

    if recipe.pattern is Pattern.SPREAD:
        # Where they lie does not matter here, and would need the mesh.
        places = [
            Position(name=f"point{k:03d}", target_mm=(0.0, 0.0, 0.0)) for k in range(recipe.points)
        ]
    else:
        places = positions_of(recipe)
    cases = deal(recipe, places)
    done, times = 0, []
    if (options.out / MANIFEST).exists():
        data = DataSet.open(options.out)
        if data.key != recipe.key:
            raise DesignError(
                f"{options.out} holds a data set of another recipe",
                hint="give the options that it was begun with",
                at="--out",
            )
        failed = {row["id"] for row in read_rows(options.out / FAILED)}
        done = sum(len(data.frames(case)) for case in cases)
        done += sum(case.frames - len(data.frames(case)) for case in cases if case.id in failed)
        times = read_rows(options.out / TIMES)
    samples = sum(case.frames for case in cases)
    found = {
        "cases": len(cases),
        "samples": samples,
        "samples_distinct": sum(case.frames - case.first_new for case in cases),
        **estimate(times, samples - done),
    }
    if options.json:
        say(json.dumps(found))
    else:
        say(
            f"{found['cases']:,} cases, {found['samples']:,} samples "
            f"({found['samples_distinct']:,} distinct states)"
        )
        say(estimate_text(found))
    return 0


def status(options: argparse.Namespace, project: Project) -> int:
    """Say how far a data set is, and what failed."""
    from workbench.dataset.folder import DataSet

    data = DataSet.open(options.folder)
    counts, failed = data.counts(), data.failed()
    if options.json:
        told = {"key": data.key, "program": data.manifest["program"], **counts}
        say(json.dumps({**told, "failed": list(failed.values())}))
        return 0
    say(
        f"{counts['samples_done']} of {counts['samples']} samples ({counts['samples_distinct']} "
        f"distinct), {counts['cases_done']} of {counts['cases']} cases complete, "
        f"{counts['cases_failed']} failed"
    )
    splits = counts["samples_by_split"]
    say("samples by split: " + ", ".join(f"{name} {count}" for name, count in splits.items()))
    for name, row in failed.items():
        say(f"failed {name}: {row['message']}")
    return 0


def preview(options: argparse.Namespace, project: Project) -> int:
    """Draw a sheet of samples."""
    from workbench.dataset.folder import DataSet
    from workbench.dataset.preview import PREVIEW, write_preview

    if not write_preview(DataSet.open(options.folder)):
        raise DesignError(
            f"{options.folder} has no samples yet", hint="make some first", at=str(options.folder)
        )
    path = options.folder / PREVIEW
    say(json.dumps({"file": str(path)}) if options.json else path)
    return 0


def repair(options: argparse.Namespace, project: Project) -> int:
    """Drop damaged samples and forget failures, so that make tries them anew."""
    from workbench.dataset.repair import repair as repair_it

    dropped = repair_it(options.folder)
    for path, reason in dropped:
        row = {"dropped": str(path), "reason": reason}
        say(json.dumps(row) if options.json else f"dropped {path}: {reason}")
    if not options.json:
        say(f"{len(dropped)} damaged samples dropped")
    return 0


def recipes(options: argparse.Namespace, project: Project) -> int:
    """List the recipes that come with the program."""
    for name, (_, purpose) in RECIPES.items():
        row = {"name": name, "purpose": purpose}
        say(json.dumps(row) if options.json else f"{name:14} {purpose}")
    return 0


class _Line:
    """Progress of samples: one line that is rewritten, or one every few seconds."""

    def __init__(self, *, as_json: bool) -> None:
        self.as_json = as_json
        self.rewrites = not as_json and sys.stderr.isatty()
        self._said_s = 0.0
        self._shown = ""

    def tell(self, told: Any) -> None:
        """Show how far it is."""
        if self.as_json:
            line = json.dumps({"stage": "samples", **dataclasses.asdict(told)})
        else:
            left = "" if told.eta_s is None else f", {human_seconds(told.eta_s)} left"
            bad = f", {told.failed} cases failed" if told.failed else ""
            line = f"{told.done} of {told.total} samples{left}{bad}"
        now = time.monotonic()
        if line == self._shown or (not self.rewrites and now - self._said_s < TOLD_S):
            return
        self._said_s, self._shown = now, line
        if self.as_json:
            say(line)
        elif self.rewrites:
            complain(f"\r\x1b[K{line}", end="")
        else:
            complain(line)

    def end(self) -> None:
        """Leave the line that is rewritten."""
        if self.rewrites and self._shown:
            complain("")
